"""Who is on the chip's buses: a host that speaks canter.dbc, and an ODrive."""

import bisect
import struct

MILLISECOND = 1_000_000  # ns
SESSION = 0xC0DE
BEAT = 100 * MILLISECOND


def send_at(bus, at, identifier, data):
    """Queues a frame in the order of time."""
    bisect.insort(bus.to_send, (at, identifier, data), key=lambda frame: frame[0])


class Refused(AssertionError):
    """A command's answer is no."""

    def __init__(self, command, answer):
        super().__init__(f"{command} is refused: {answer}")
        self.reason = str(answer["reason"])


class Host:
    """Sends commands on the host's bus and waits for their answers, in the chip's own time."""

    def __init__(self, chip, database):
        self.chip, self.bus, self.database = chip, chip.host.bus, database
        self.sequence = 0
        self.begin = 0  # of what counts, in the bus's log
        self.beating_until = 0

    def send(self, name, **fields):
        """A frame, now."""
        message = self.database.get_message_by_name(name)
        send_at(self.bus, self.chip.now, message.frame_id, message.encode(fields))

    def send_sync(self, at, counter, ahead):
        """A SYNC at this time, or soon after; bus time is so many ns ahead of the chip's."""
        message = self.database.get_message_by_name("Sync_all")

        def data():
            time = (self.chip.now + ahead) // 1000 / 1e6
            return message.encode({"counter": counter, "time": time})

        send_at(self.bus, at, message.frame_id, data)

    def beat(self, until):
        """Keeps the session alive until then."""
        message = self.database.get_message_by_name("HostHeartbeat_all")
        at = max(self.chip.now, self.beating_until)
        while at < until:
            send_at(
                self.bus, at, message.frame_id, message.encode({"session": SESSION})
            )
            at += BEAT
        self.beating_until = at

    def listen(self):
        """Forgets what was on the bus until now."""
        self.begin = len(self.bus.log)

    def heard(self, name):
        """The frames of this name since `listen`: when each ended, and its fields."""
        message = self.database.get_message_by_name(name)
        frames = self.bus.log[self.begin :]
        return [
            (at, message.decode(data, decode_choices=True))
            for at, identifier, data in frames
            if identifier == message.frame_id
        ]

    def run(self, milliseconds, until=None):
        """Lets time pass."""
        return self.chip.run(self.chip.now + milliseconds * MILLISECOND, until)

    def next_sequence(self):
        """The number of the next command."""
        self.sequence = self.sequence % 255 + 1
        return self.sequence

    def command(self, name, axis, patience=20, **fields):
        """Sends a command; its answer, which must come within so many ms and be accepted."""
        sequence = self.next_sequence()
        self.listen()
        self.send(f"{name}_{axis}", sequence=sequence, **fields)

        def answers():
            heard = self.heard(f"Acknowledgement_{axis}")
            return [fields for _, fields in heard if fields["sequence"] == sequence]

        if not self.run(patience, answers):
            raise AssertionError(
                f"{name} to axis {axis} has no answer within {patience} ms"
            )
        answer = answers()[0]
        if str(answer["reason"]) != "accepted":
            raise Refused(f"{name} to axis {axis}", answer)
        return answer

    def control(self, action, axis, **more):
        """One of the actions of Control."""
        return self.command("Control", axis, action=action, session=SESSION, **more)


class Odrive:
    """A drive on the drives' bus that is at once where it is told to be. Firmware 0.6."""

    HEARTBEAT, SET_STATE, ESTIMATES, SET_POSITION = 0x01, 0x07, 0x09, 0x0C
    IDLE, CLOSED_LOOP = 1, 8

    def __init__(self, bus, node):
        self.bus, self.base = bus, node << 5
        self.state, self.position, self.velocity = self.IDLE, 0.0, 0.0
        self.setpoints = []  # (when, turns)
        bus.listener = self._hear

    def live(self, begin, until):
        """Ten heartbeats and a hundred estimates in a second."""
        for at in range(begin, until, 10 * MILLISECOND):
            send_at(self.bus, at, self.base | self.ESTIMATES, self._estimates)
            if (at - begin) % (100 * MILLISECOND) == 0:
                send_at(self.bus, at, self.base | self.HEARTBEAT, self._heartbeat)

    def _heartbeat(self):
        return struct.pack("<IBBBB", 0, self.state, 0, 0, 0)

    def _estimates(self):
        return struct.pack("<ff", self.position, self.velocity)

    def _hear(self, at, identifier, data):
        if identifier == self.base | self.SET_STATE:
            self.state = int.from_bytes(data, "little")
        elif identifier == self.base | self.SET_POSITION:
            position, velocity, _ = struct.unpack("<fhh", data)
            self.setpoints.append((at, position))
            if self.state == self.CLOSED_LOOP:
                self.position, self.velocity = position, velocity / 1000
