"""The devices of the bench, one a line; the chosen one is shown in full."""

from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import OptionList

from catseye.app.tui.bench_text import alarm_text, device_line, device_text
from catseye.app.tui.dialogs.text_dialog import TextDialog

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import BenchStatus


class DeviceList(OptionList):
    """Devices with link, age and identity."""

    DEFAULT_CSS = """
    DeviceList {
        height: auto; max-height: 8; background: $background; scrollbar-size-vertical: 1;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    DeviceList > .option-list--option-highlighted { text-style: none; background: $surface; color: $foreground; }
    DeviceList:focus > .option-list--option-highlighted { background: $panel; color: $foreground; }
    """

    def __init__(self) -> None:
        super().__init__(classes="panel", compact=True, markup=False)
        self.border_title = "Devices"
        self.border_subtitle = "Enter: all about one"
        self._bench: BenchStatus | None = None
        self._since_s = 0.0
        self._shown: list[Content] = []

    def show(self, bench: "BenchStatus | None", since_s: float) -> None:
        """Show the devices; what is chosen stays so."""
        self._bench, self._since_s = bench, since_s
        lines = [] if bench is None else [device_line(device, since_s) for device in bench.devices]
        if len(lines) != len(self._shown):
            self.set_options(lines)
            self.highlighted = 0 if lines else None
        else:
            for number, (line, shown) in enumerate(zip(lines, self._shown, strict=True)):
                if not line.is_same(shown):
                    self.replace_option_prompt_at_index(number, line)
        self._shown = lines

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Show everything about a device."""
        event.stop()
        if self._bench is not None and event.option_index < len(self._bench.devices):
            device, robot = self._bench.devices[event.option_index], self._bench.robot
            alarm = alarm_text(robot) if device.name == "robot" and robot is not None else ""
            self.app.push_screen(TextDialog(device.name, device_text(device, alarm, self._since_s)))
