"""What the palette lists before anything is typed: screens first, so that Enter alone changes nothing."""

from textual.command import DiscoveryHit, Hits
from textual.system_commands import SystemCommandsProvider


class Actions(SystemCommandsProvider):
    """The actions in the order in which the program lists them; by the alphabet the first one would abort the run."""

    async def discover(self) -> Hits:
        """Yield the actions."""
        for command in self.app.get_system_commands(self.screen):
            if command.discover:
                yield DiscoveryHit(command.title, command.callback, help=command.help)
