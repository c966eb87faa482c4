"""An FDCAN of an STM32G474 and the bus that it is on, after RM0440. Classic frames with 11-bit ids."""

from clocks import Registers
from processor import Stuck
from timers import SECOND

CORE, ENDIAN, CONTROL, BIT_TIMING, ERRORS, PROTOCOL = 0x00, 0x04, 0x18, 0x1C, 0x40, 0x44
TIMESTAMP = 0x24
FLAGS, ENABLED_FLAGS, SECOND_LINE, LINES = 0x50, 0x54, 0x58, 0x5C
FILTER = 0x80
RECEIVED, RELEASE = (0x90, 0x98), (0x94, 0x9C)
BUFFERS, FREE, REQUESTED, REQUEST, CANCEL = 0xC0, 0xC4, 0xC8, 0xCC, 0xD0
SENT, CANCELLED, SENT_FLAGS, CANCELLED_FLAGS = 0xD4, 0xD8, 0xDC, 0xE0

INIT, CHANGE, STOPPED, STOP = 1 << 0, 1 << 1, 1 << 3, 1 << 4
# Written only while both INIT and CHANGE are set.
PROTECTED = (0x0C, 0x14, BIT_TIMING, 0x20, 0x48, FILTER, BUFFERS)
PROTECTED_CONTROL = 0xF1E4

NEW, FULL, LOST = (1 << 0, 1 << 3), (1 << 1, 1 << 4), (1 << 2, 1 << 5)
BUS_OFF, BUS_OFF_CHANGED = 1 << 7, 1 << 19  # in PROTOCOL and in FLAGS
TRANSMITTED, CANCELLATION = 1 << 7, 1 << 8
# What a bit of SECOND_LINE moves there.
GROUPS = (0x7, 0x38, 0x1C0, 0x1E00, 0xE000, 0x30000, 0xFC0000)

# Offsets in the message RAM.
STANDARD_FILTERS, FILTERS, FIFOS, OUT, ELEMENT, DEPTH = (
    0x70,
    0xB0,
    (0xB0, 0x188),
    0x278,
    72,
    3,
)
MESSAGE_RAM = 0x350


class Bus:
    """A bus with one controller and the harness on it, which acknowledges whatever is sent right."""

    RATE = 1_000_000

    def __init__(self):
        self.free = 0  # when the frame that is on the bus ends
        self.under_way = None
        self.to_send = (
            []
        )  # of the harness: (not before, id, data or what gives it then)
        self.log = []  # (when it ended, id, data), both ways
        self.listener = None
        self.has_peer = (
            True  # without one nobody acknowledges, and a frame is tried for ever
        )

    def next(self, controller):
        """When something happens next."""
        if self.under_way:
            return self.free
        waits = [max(self.free, frame[0]) for frame in self.to_send[:1]]
        if self._takes(controller):
            waits.append(self.free)
        if controller.rejoins:
            waits.append(controller.rejoins)
        return min(waits, default=None)

    def _takes(self, controller):
        return controller.waiting and controller.is_on() and self.has_peer

    def advance(self, now, controller):
        """Ends the frame that is on the bus, and begins the next: the lowest id wins."""
        if controller.rejoins and now >= controller.rejoins:
            controller.leave_bus_off()
        if self.under_way and now >= self.free:
            index, identifier, data = self.under_way
            self.under_way = None
            self.log.append((self.free, identifier, data))
            if index is None:
                controller.receive(identifier, data)
            else:
                controller.sent(index)
                if self.listener:
                    self.listener(self.free, identifier, data)
        if not self.has_peer:
            self.to_send = [frame for frame in self.to_send if frame[0] > now]
        if self.under_way or now < self.free:
            return
        offers = [
            (identifier, None, data)
            for at, identifier, data in self.to_send[:1]
            if at <= now
        ]
        if self._takes(controller):
            offers.append(controller.offer())
        if offers:
            identifier, index, data = min(offers, key=lambda offer: offer[0])
            if index is None:
                self.to_send.pop(0)
                data = data() if callable(data) else data
            # As if every fourth bit were followed by a stuffed one: the longest that it can be.
            bits = 47 + 8 * len(data) + (33 + 8 * len(data)) // 4
            self.free = now + bits * SECOND // self.RATE
            self.under_way = (index, identifier, data)


class Controller(Registers):
    """One FDCAN. `ram` is where its message RAM is, `pins` whether it is wired to its bus."""

    def __init__(self, chip, ram, interrupts, pins):
        self.chip, self.ram, self.interrupts, self.pins = chip, ram, interrupts, pins
        self.bus = Bus()
        super().__init__(
            {CORE: 0x32141218, ENDIAN: 0x87654321, CONTROL: INIT, PROTOCOL: 0x707}
        )

    def reset(self):
        super().reset()
        self.waiting = []  # buffers in the order of their requests
        self.put = 0
        self.levels, self.gets, self.lost = [0, 0], [0, 0], [0, 0]
        self.started = 0
        self.rejoins = None  # when its wait after bus-off ends

    def is_on(self):
        """Whether it takes part in its bus; then it must do so at the bus's rate."""
        if self.words[CONTROL] & (INIT | STOP) or not self.pins():
            return False
        if self.words[PROTOCOL] & BUS_OFF:
            return False
        if self.timing()[0] != Bus.RATE:
            raise Stuck(
                f"an FDCAN with {self.timing()[0]} bit/s on a bus with {Bus.RATE}"
            )
        return True

    def timing(self):
        """Bit rate in bit/s, sample point in thousandths of a bit, and jump width in quanta."""
        word = self.words.get(BIT_TIMING, 0x6000A03)
        before, after = (word >> 8 & 0xFF) + 2, (word & 0x7F) + 1
        quanta = before + after
        rate = self.chip.clocks.can() // ((word >> 16 & 0x1FF) + 1) // quanta
        return rate, 1000 * before // quanta, (word >> 25) + 1

    # Registers.

    def read(self, offset):
        if offset in RECEIVED:
            return self._fifo(RECEIVED.index(offset))
        if offset == FREE:
            waiting = len(self.waiting)
            return (
                DEPTH - waiting | self.put << 16 | (1 << 21 if waiting == DEPTH else 0)
            )
        if offset == REQUESTED:
            return sum(1 << index for index in self.waiting)
        if offset == TIMESTAMP and not self.words[CONTROL] & INIT:
            return (self.chip.now - self.started) * self.timing()[0] // SECOND & 0xFFFF
        return super().read(offset)

    def write(self, offset, value):
        control = self.words[CONTROL]
        if offset in PROTECTED and control & (INIT | CHANGE) != INIT | CHANGE:
            raise Stuck(f"the protected register {offset:#x} of an FDCAN is written")
        if offset == CONTROL:
            self._control(value)
        elif offset == FLAGS:
            self.words[FLAGS] = self.words.get(FLAGS, 0) & ~value
        elif offset in RELEASE:
            self._release(RELEASE.index(offset), value & 7)
        elif offset == REQUEST:
            for index in range(DEPTH):
                if value >> index & 1 and index not in self.waiting:
                    self._request(index)
        elif offset == CANCEL:
            self._cancel(value)
        elif offset == BUFFERS and value & 1 << 24:
            raise Stuck("an FDCAN sends by priority, which is not modelled")
        else:
            super().write(offset, value)
        self._signal()

    def _control(self, value):
        control = self.words[CONTROL]
        if not control & CHANGE and (value & ~control) & PROTECTED_CONTROL:
            raise Stuck(f"FDCAN_CCCR becomes {value:#x} without CCE")
        value = value & ~STOPPED | (STOPPED if value & STOP else 0)
        if not value & INIT:
            value &= ~CHANGE
            if control & INIT:
                self.started = self.chip.now
                if self.words[PROTOCOL] & BUS_OFF:
                    # 129 times 11 recessive bits.
                    self.rejoins = self.chip.now + 1419 * SECOND // self.timing()[0]
                self._check_filters()
        elif value & CHANGE and not control & CHANGE:
            # RM0440: these registers are reset when CCE is set.
            self.waiting, self.put = [], 0
            self.levels, self.gets = [0, 0], [0, 0]
        self.words[CONTROL] = value

    def _check_filters(self):
        # An element is in use where its bits 27 to 29, or 29 to 31, are not 0.
        standard = self.chip.memory(self.ram, STANDARD_FILTERS)[3::4]
        extended = self.chip.memory(
            self.ram + STANDARD_FILTERS, FILTERS - STANDARD_FILTERS
        )[3::8]
        if any(byte & 0x38 for byte in standard) or any(
            byte & 0xE0 for byte in extended
        ):
            raise Stuck("an FDCAN has filters, which are not modelled")

    def _signal(self):
        raised = self.words.get(FLAGS, 0) & self.words.get(ENABLED_FLAGS, 0)
        moved = self.words.get(SECOND_LINE, 0)
        second = sum(mask for bit, mask in enumerate(GROUPS) if moved >> bit & 1)
        on = self.words.get(LINES, 0)
        for line, mask in enumerate((~second, second)):
            high = bool(on >> line & 1 and raised & mask)
            self.chip.processor.set_line(self.interrupts[line], high)

    def _raise(self, flags):
        self.words[FLAGS] = self.words.get(FLAGS, 0) | flags
        self._signal()

    def go_bus_off(self):
        """As after 32 frames that failed one after the other."""
        self.words[PROTOCOL] |= BUS_OFF
        self.words[CONTROL] |= INIT
        self._raise(BUS_OFF_CHANGED)

    def leave_bus_off(self):
        """The wait after bus-off has ended."""
        self.rejoins = None
        self.words[PROTOCOL] &= ~BUS_OFF
        self._raise(BUS_OFF_CHANGED)

    # Frames in.

    def _fifo(self, number):
        level, get = self.levels[number], self.gets[number]
        put = (get + level) % DEPTH
        return (
            level
            | get << 8
            | put << 16
            | (level == DEPTH) << 24
            | self.lost[number] << 25
        )

    def _release(self, number, index):
        released = (index - self.gets[number]) % DEPTH + 1
        if released > self.levels[number]:
            raise Stuck("a frame is released that an FDCAN has not received")
        self.levels[number] -= released
        self.gets[number] = (index + 1) % DEPTH

    def receive(self, identifier, data):
        """A frame ended well."""
        number = self.words.get(FILTER, 0) >> 4 & 3
        if not self.is_on() or number > 1:
            return
        if self.levels[number] == DEPTH:
            self.lost[number] = 1
            self._raise(LOST[number])
            return
        self.lost[number] = 0
        index = (self.gets[number] + self.levels[number]) % DEPTH
        # Bit 31: no filter matched it.
        head = [identifier << 18, 1 << 31 | len(data) << 16 | self.read(TIMESTAMP)]
        words = b"".join(word.to_bytes(4, "little") for word in head)
        place = self.ram + FIFOS[number] + ELEMENT * index
        self.chip.set_memory(place, words + data.ljust(8, b"\0"))
        self.levels[number] += 1
        self._raise(NEW[number] | (FULL[number] if self.levels[number] == DEPTH else 0))

    # Frames out.

    def _request(self, index):
        if index != self.put:
            raise Stuck(
                f"buffer {index} of an FDCAN's FIFO is sent, and {self.put} is the next"
            )
        self.waiting.append(index)
        self.put = (self.put + 1) % DEPTH
        for register in (SENT, CANCELLED):
            self.words[register] = self.words.get(register, 0) & ~(1 << index)

    def _cancel(self, value):
        sending = self.bus.under_way and self.bus.under_way[0]
        for index in [
            index for index in self.waiting if value >> index & 1 and index != sending
        ]:
            self.waiting.remove(index)
            self.words[CANCELLED] = self.words.get(CANCELLED, 0) | 1 << index
            if self.words.get(CANCELLED_FLAGS, 0) >> index & 1:
                self._raise(CANCELLATION)

    def offer(self):
        """The frame that is to be sent next: id, buffer, data."""
        index = self.waiting[0]
        head = self.chip.memory(self.ram + OUT + ELEMENT * index, 16)
        words = [int.from_bytes(head[at : at + 4], "little") for at in (0, 4)]
        length = words[1] >> 16 & 0xF
        if words[0] >> 29 or words[1] >> 20 & 3 or length > 8:
            raise Stuck(
                "an FDCAN sends something else than a classic frame with an 11-bit id"
            )
        return words[0] >> 18 & 0x7FF, index, bytes(head[8 : 8 + length])

    def sent(self, index):
        """The frame was acknowledged."""
        # A reset of the chip forgets what is on its way; the frame gets through all the same.
        if index not in self.waiting:
            return
        self.waiting.remove(index)
        self.words[SENT] = self.words.get(SENT, 0) | 1 << index
        if self.words.get(SENT_FLAGS, 0) >> index & 1:
            self._raise(TRANSMITTED)
