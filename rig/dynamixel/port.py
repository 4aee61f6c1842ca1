"""The SDK's port, opened as all ports of the rig are: exclusively, and so that it can be recorded and replayed."""

from dynamixel_sdk import PortHandler

from rig.serial_port import open_serial

BITS_PER_BYTE = 10


class ExclusivePort(PortHandler):  # type: ignore[misc]  # the SDK has no types
    """A `PortHandler` that goes through `open_serial`."""

    is_open: bool

    def setupPort(self, _: int) -> bool:  # noqa: N802  # the SDK's name
        """Open the port at `baudrate`; called by `setBaudRate`.

        Raises
        ------
        PortError
            It is missing, forbidden or taken.
        """
        if self.is_open:
            self.closePort()
        self.ser = open_serial(self.port_name, self.baudrate)
        self.is_open = True
        self.ser.reset_input_buffer()
        self.tx_time_per_byte = 1000.0 / self.baudrate * BITS_PER_BYTE  # the SDK counts in milliseconds
        return True
