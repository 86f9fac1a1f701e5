"""Which path leads to which resource."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from catseye.simulators.abb import panel, services, tasks
from catseye.simulators.abb.calls import Call, Handler
from catseye.simulators.abb.http import Answer
from catseye.simulators.abb.replies import NOT_FOUND, RefusedError, refused

_TABLE: Final[tuple[tuple[str, str, Handler], ...]] = (
    ("GET", r"rw/system", panel.system),
    ("GET", r"rw/panel/ctrlstate", panel.control_state),
    ("POST", r"rw/panel/ctrlstate", panel.set_control_state),
    ("GET", r"rw/panel/opmode", panel.operating_mode),
    ("GET", r"rw/panel/speedratio", panel.speed_ratio),
    ("POST", r"rw/panel/speedratio", panel.set_speed_ratio),
    ("GET", r"rw/motionsystem/mechunits/([^/]+)/jointtarget", panel.joint_target),
    ("GET", r"rw/motionsystem/mechunits/([^/]+)/robtarget", panel.robot_target),
    ("POST", r"rw/mastership", panel.mastership),
    ("POST", r"rw/mastership/([^/]+)", panel.mastership),
    ("GET", r"rw/rapid/execution", tasks.execution),
    ("POST", r"rw/rapid/execution", tasks.change_execution),
    ("GET", r"rw/rapid/tasks", tasks.tasks),
    ("POST", r"rw/rapid/tasks/([^/]+)", tasks.change_task),
    ("POST", r"rw/rapid/symbols", tasks.search_symbols),
    ("GET", r"rw/rapid/symbol/data/(RAPID/.+)", tasks.symbol_value),
    ("POST", r"rw/rapid/symbol/data/(RAPID/.+)", tasks.set_symbol_value),
    ("GET", r"rw/iosystem/signals/([^/]+/[^/]+/[^/]+)", services.signal),
    ("POST", r"rw/iosystem/signals/([^/]+/[^/]+/[^/]+)", services.set_signal),
    ("GET", r"rw/elog/([^/]+)", services.event_log),
    ("GET", r"ctrl/\$RAMDISK", services.ramdisk),
    ("GET", r"fileservice/(.+)", services.read_file),
    ("PUT", r"fileservice/(.+)", services.write_file),
    ("DELETE", r"fileservice/(.+)", services.delete_file),
    ("POST", r"rw/dipc", services.create_queue),
    ("POST", r"rw/dipc/([^/]+)", services.send_message),
    ("GET", r"rw/dipc/([^/]+)", services.read_messages),
    ("POST", r"users/rmmp", services.request_remote_control),
    ("GET", r"users/rmmp/poll", services.poll_remote_control),
)


class Resources:
    """The resources of a controller.

    Args:
        further: resources of the server itself, as in the table.
    """

    def __init__(self, further: tuple[tuple[str, str, Handler], ...]) -> None:
        self._table = [(method, re.compile(path), handle) for method, path, handle in (*_TABLE, *further)]

    def answer(self, call: Call) -> Answer:
        """Carry out a call; what is refused is answered, too."""
        path = call.request.path
        # A client may ask for a part of a resource behind a semicolon.
        found = self._found(call.request.method, path.partition(";")[0])
        try:
            if found is None:
                raise RefusedError(404, NOT_FOUND, f"there is no {call.request.method} {path[:80]}")
            handle, parts = found
            return handle(replace(call, parts=parts))
        except RefusedError as error:
            return refused(error, path, as_json=call.as_json)

    def _found(self, method: str, path: str) -> tuple[Callable[[Call], Answer], tuple[str, ...]] | None:
        for known, pattern, handle in self._table:
            if known == method and (match := pattern.fullmatch(path)):
                return handle, match.groups()
        return None
