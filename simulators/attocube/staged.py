"""Settings that act only once they are applied, as in the services axis, realtime and network."""

from collections.abc import Mapping

Setting = int | bool | str


class Staged:
    """Settings of one service.

    Args:
        values: what acts at the start.
        shows_pending: getters show what waits for `apply`; otherwise what acts. The maker's API does not say.
    """

    def __init__(self, values: Mapping[str, Setting], *, shows_pending: bool) -> None:
        self._acting = dict(values)
        self._pending: dict[str, Setting] = {}
        self._shows_pending = shows_pending

    @property
    def acting(self) -> Mapping[str, Setting]:
        """What acts."""
        return self._acting

    @property
    def wanted(self) -> Mapping[str, Setting]:
        """What will act after `apply`."""
        return self._acting | self._pending

    def get(self, key: str) -> list[object]:
        """Answer a getter."""
        shown = self.wanted if self._shows_pending else self._acting
        return [0, shown[key]]

    def set(self, key: str, value: Setting) -> list[object]:
        """Keep a value until `apply`."""
        self._pending[key] = value
        return [0]

    def put(self, key: str, value: Setting) -> list[object]:
        """Let a value act at once."""
        self._acting[key] = value
        return [0]

    def apply(self) -> list[object]:
        """Let what waits act."""
        self._acting |= self._pending
        return self.discard()

    def discard(self) -> list[object]:
        """Drop what waits."""
        self._pending.clear()
        return [0]
