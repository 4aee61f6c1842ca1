"""One servo on a bus."""

from rig.clock import Clock
from rig.dynamixel.bus import DynamixelBus, Identity
from rig.dynamixel.registers import Block, Register, Values


class ServoLink:
    """One of the servos on a bus.

    Attributes
    ----------
    alert : whether the last answer said that the hardware error status has something to tell
    """

    def __init__(self, bus: DynamixelBus, servo_id: int) -> None:
        self.name = f"servo {servo_id} on {bus.name}"
        self.alert = False
        self._bus, self._id = bus, servo_id

    @property
    def uncertain(self) -> bool:
        """Whether the last exchange on the bus failed or was broken off."""
        return self._bus.uncertain

    def ping(self) -> Identity:
        """Ask who it is."""
        return self._bus.ping(self._id)

    def read(self, register: Register) -> int:
        """Read a register."""
        reply = self._bus.read(self._id, register)
        self.alert = reply.alert
        return register.from_bytes(reply.content)

    def read_block(self, block: Block) -> Values:
        """Read a stretch of registers at one instant."""
        reply = self._bus.read(self._id, block)
        self.alert = reply.alert
        return block.values(reply.content)

    def write(self, register: Register, value: int) -> None:
        """Write a register, and wait until the servo says that it took it."""
        self.alert = self._bus.write(self._id, register, value).alert

    def shout(self, register: Register, value: int) -> None:
        """Write a register at once, whatever is under way, and wait for nothing."""
        self._bus.shout(self._id, register, value)

    def drain(self, longest_s: float) -> None:
        """Throw away what is under way on the wire."""
        self._bus.drain(longest_s)

    def close(self) -> None:
        """Give the port back, for all servos on it."""
        self._bus.close()


class DynamixelLink(ServoLink):
    """The only servo on an exclusively opened port."""

    def __init__(self, path: str, baud: int, servo_id: int, clock: Clock) -> None:
        """Open the port.

        Raises
        ------
        PortError
            It is missing, forbidden or taken, or no servo has such a baud rate.
        """
        super().__init__(DynamixelBus.open(path, baud, clock), servo_id)
