"""A timer with two compare channels, and the independent watchdog, of an STM32G474 after RM0440."""

from clocks import Registers
from processor import Stuck

SECOND = 1_000_000_000  # in ns, as all times here are

CONTROL, ENABLED_INTERRUPTS, STATUS, GENERATE = 0x00, 0x0C, 0x10, 0x14
COUNTER, PRESCALER, RELOAD, COMPARE_1, COMPARE_2 = 0x24, 0x28, 0x2C, 0x34, 0x38


class Timer(Registers):
    """TIM15, counting upwards."""

    def __init__(self, chip, interrupt):
        self.chip, self.interrupt = chip, interrupt
        super().__init__({RELOAD: 0xFFFF})

    def reset(self):
        super().reset()
        self.divider = 1  # what is written to PRESCALER counts from the next update on
        self.begin = self.seen = None

    def read(self, offset):
        self.advance()
        if offset == COUNTER and self.begin is not None:
            return self.ticks() % self.period()
        return super().read(offset)

    def write(self, offset, value):
        self.advance()
        if offset == STATUS:
            value &= self.words.get(STATUS, 0)
        super().write(offset, value)
        if offset == GENERATE and value & 1:
            self.words[COUNTER] = 0
            self.divider = self.words.get(PRESCALER, 0) + 1
            if not self.words.get(CONTROL, 0) & 1 << 2:
                self.words[STATUS] = self.words.get(STATUS, 0) | 1
        if offset == CONTROL and value & 1 and self.begin is None:
            if self.words.get(COUNTER, 0):
                raise Stuck("the timer begins elsewhere than at 0")
            self.begin, self.before, self.seen = self.chip.now, 0, 0
            self.clock = self.chip.clocks.timer()
        elif self.begin is not None and offset in (COUNTER, PRESCALER, GENERATE):
            raise Stuck(f"register {offset:#x} of a running timer is written")
        self._signal()

    def period(self):
        """Ticks from overflow to overflow."""
        return self.words[RELOAD] + 1

    def ticks(self):
        """Since the timer began."""
        return self.before + (self.chip.now - self.begin) * self.clock // (
            SECOND * self.divider
        )

    def change_clock(self):
        """Goes on from here at another rate."""
        if self.begin is not None:
            self.advance()
            self.begin, self.before = self.chip.now, self.seen
            self.clock = self.chip.clocks.timer()

    def _events(self):
        compared = [self.words.get(COMPARE_1, 0), self.words.get(COMPARE_2, 0)]
        return enumerate([0, *compared])

    def advance(self):
        """Raises what came between the last look and now."""
        if self.begin is None:
            return
        seen, self.seen, period = self.seen, self.ticks(), self.period()
        for bit, at in self._events():
            if (self.seen - at) // period > (seen - at) // period:
                self.words[STATUS] = self.words.get(STATUS, 0) | 1 << bit
        self._signal()

    def next(self):
        """When its next interrupt is due."""
        if self.begin is None:
            return None
        period, ticks = self.period(), []
        for bit, at in self._events():
            if self.words.get(ENABLED_INTERRUPTS, 0) >> bit & 1:
                ticks.append(self.seen + 1 + (at - self.seen - 1) % period)
        due = [
            -((self.before - tick) * SECOND * self.divider // self.clock)
            for tick in ticks
        ]
        return self.begin + min(due) if due else None

    def _signal(self):
        raised = self.words.get(STATUS, 0) & self.words.get(ENABLED_INTERRUPTS, 0) & 7
        self.chip.processor.set_line(self.interrupt, bool(raised))


class Watchdog(Registers):
    """IWDG, with an LSI of exactly 32 kHz."""

    KEY, DIVIDER, LENGTH = 0x00, 0x04, 0x08
    FEED, START = 0xAAAA, 0xCCCC

    def __init__(self, chip):
        self.chip = chip
        self.longest = 0  # between two feeds
        super().__init__({self.LENGTH: 0xFFF})

    def reset(self):
        super().reset()
        self.deadline = None
        self.fed = None

    def write(self, offset, value):
        super().write(offset, value)
        running = self.deadline is not None
        if offset == self.KEY and (
            value == self.START or (value == self.FEED and running)
        ):
            clocks = (self.words[self.LENGTH] + 1) * (
                4 << self.words.get(self.DIVIDER, 0)
            )
            self.deadline = self.chip.now + clocks * SECOND // 32_000
            if running:
                self.longest = max(self.longest, self.chip.now - self.fed)
            self.fed = self.chip.now

    def next(self):
        """When it bites."""
        return self.deadline

    def advance(self):
        """Bites if it was not fed in time."""
        if self.deadline is not None and self.chip.now >= self.deadline:
            self.chip.watchdog_bites = True
