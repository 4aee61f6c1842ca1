"""The registers of one servo: bytes in and out, with the refusals that the control table asks for."""

from firmware_sim.dynamixel.control_table import FIRST_RAM_ADDRESS, TABLE, TABLE_BYTES, Item, Register
from firmware_sim.dynamixel.packets import ErrorCode


class Refusal(Exception):  # noqa: N818 - it is an answer on the wire, no mishap of ours
    """An instruction that the servo answers with an error code."""

    def __init__(self, code: ErrorCode) -> None:
        super().__init__(code.name)
        self.code = code


class Memory:
    """Registers by name, signed where the table's limits are."""

    def __init__(self) -> None:
        self._values: dict[Register, int] = {item.register: item.initial for item in TABLE}

    def __getitem__(self, register: Register) -> int:
        return self._values[register]

    def __setitem__(self, register: Register, value: int) -> None:
        self._values[register] = value

    def factory_reset(self, *keep: Register) -> None:
        """Set everything but what tells the servo's own self, and what is to be kept, to its initial value."""
        own = {item.register for item in TABLE if item.register < Register.ID} | set(keep)
        self._values.update({item.register: item.initial for item in TABLE if item.register not in own})

    def forget_ram(self) -> None:
        """Set everything that a reboot clears to its initial value."""
        self._values.update({item.register: item.initial for item in TABLE if item.register >= FIRST_RAM_ADDRESS})

    def read(self, address: int, length: int) -> bytes:
        """Return bytes; places without a register read 0."""
        if address + length > TABLE_BYTES:
            raise Refusal(ErrorCode.DATA_RANGE)
        image = bytearray(TABLE_BYTES)
        for item in TABLE:
            if item.register < address + length and address < item.end:
                image[item.register : item.end] = _to_bytes(self._values[item.register], item.size)
        return bytes(image[address : address + length])

    def parse_write(self, address: int, content: bytes) -> dict[Register, int]:
        """Split a write into registers and check it as a whole; nothing is stored yet."""
        if address + len(content) > TABLE_BYTES:
            raise Refusal(ErrorCode.DATA_RANGE)
        items = [item for item in TABLE if item.register < address + len(content) and address < item.end]
        if sum(item.size for item in items) != len(content) or items[0].register != address:
            # Half a register is a length error, a place without a register cannot be written at all.
            partial = any(item.register < address or item.end > address + len(content) for item in items)
            raise Refusal(ErrorCode.DATA_LENGTH if partial else ErrorCode.ACCESS)
        return {item.register: self._check(item, content, address) for item in items}

    def _check(self, item: Item, content: bytes, address: int) -> int:
        locked = item.register < FIRST_RAM_ADDRESS and self[Register.TORQUE_ENABLE]
        if item.limits is None or locked:
            raise Refusal(ErrorCode.ACCESS)
        low, high = item.limits
        start = item.register - address
        value = int.from_bytes(content[start : start + item.size], "little", signed=low < 0)
        if not low <= value <= high:
            raise Refusal(ErrorCode.DATA_RANGE)
        return value


def _to_bytes(value: int, size: int) -> bytes:
    return (value % (1 << (8 * size))).to_bytes(size, "little")
