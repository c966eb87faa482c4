"""Runs the image of the NUCLEO-G474RE, unchanged, on an emulated chip, and holds it to what it promises.

Arguments: the image, its version, canter.dbc.

| file | what it holds |
|---|---|
| `chip` | memory, peripherals and time around the processor |
| `processor` | the Cortex-M4F: exceptions and their priorities around unicorn |
| `clocks` | clocks, resets, and peripherals that only hold what is written |
| `timers` | TIM15, which is the image's clock, and the watchdog |
| `flash` | the second bank, where parameters are kept |
| `fdcan` | a CAN controller and its bus |
| `host` | a host that speaks canter.dbc, and an ODrive |

Whatever is used and not modelled ends the run, and so does what the chip's manual forbids: a protected
register that is written, a peripheral without its clock, flash that was not erased.
"""

import os
import sys

import cantools

from chip import Chip
from clocks import Pins
from host import MILLISECOND, Host, Odrive, Refused
from timers import SECOND

# Nanoseconds that a tick runs before its instant: TICK_LEAD of shared/src/node.rs.
TICK_LEAD = 150_000

AXES = (1, 2, 3)
EMULATED = "nucleo-g474re, emulated:"
CHIP_ID = bytes.fromhex("0123456789abcdef02468ace")


def expect(condition, what):
    """Ends the check unless it is so."""
    if not condition:
        raise AssertionError(what)


def measured(what, value, bound):
    """Shows a figure, and hands it to tests/run."""
    print(f"firmware: {what}: {value} ({bound})")
    if path := os.environ.get("CANTER_MEASUREMENTS"):
        with open(path, "a", encoding="utf-8") as file:
            file.write(f"firmware\t{what}\t{value}\t{bound}\n")


def unsteadiness(times):
    """By how much the longest or the shortest of these gaps is not a millisecond, in ns."""
    gaps = [after - before for before, after in zip(times, times[1:])]
    return max(abs(gap - MILLISECOND) for gap in gaps)


def healthy(host, state, axes=AXES, **more):
    """Every axis's last heartbeat says this state, no fault, and nothing lost, or what `more` says."""
    wanted = {"state": state, "fault": "none", "lost": 0, "bus_off": 0} | more
    for axis in axes:
        beats = host.heard(f"Heartbeat_{axis}")
        expect(beats, f"axis {axis} sends no heartbeat")
        beat = {name: str(value) for name, value in beats[-1][1].items()}
        for field, value in wanted.items():
            expect(
                beat[field] == str(value),
                f"axis {axis}: {field} is not {value}: {beat}",
            )


def is_lit(chip):
    """LD2, on PA5."""
    return chip.pins["A"].read(Pins.OUTPUT) >> 5 & 1


def boots(host):
    """Without a debugger, from RAM that holds anything."""
    chip = host.chip
    chip.power_on()
    host.run(400)
    first = min(at for at, _ in host.heard("Heartbeat_1"))
    measured(
        f"{EMULATED} power-on to first heartbeat", f"{first // 1000} us", "< 50 ms"
    )
    expect(first < 50 * MILLISECOND, "the first heartbeat is late")
    healthy(host, "switch on disabled")
    expect(not is_lit(chip), "the LED is lit within half a second")
    for name, controller in (("host's", chip.host), ("drives'", chip.drives)):
        timing = controller.timing()
        expect(timing == (1_000_000, 875, 3), f"the {name} bus is timed {timing}")
    clock = chip.clocks.processor()
    expect(clock == 170_000_000, f"the processor has {clock} Hz")
    expect(not chip.clocks.excess(), chip.clocks.excess())


def scans(host, version):
    """Three axes of one chip tell who they are."""
    host.listen()
    host.send("IdentityRequest_all")
    host.run(10)
    for axis in AXES:
        identity = {}
        for _, part in host.heard(f"Identity_{axis}"):
            identity.update(part)
        expect(identity, f"axis {axis} does not answer a scan")
        halves = [
            identity.get(half, 0).to_bytes(6, "little")
            for half in ("chip_first", "chip_last")
        ]
        expect(b"".join(halves) == CHIP_ID, f"axis {axis} has another chip: {identity}")
        expect(str(identity["board"]) == "nucleo-g474re", f"another board: {identity}")
        numbers = [identity[f"firmware_{part}"] for part in ("major", "minor", "patch")]
        expect(
            ".".join(map(str, numbers)) == version, f"not version {version}: {identity}"
        )


def moves(host):
    """A quarter of a turn in 0.3 s along a beta S-curve, told 1000 times a second."""
    host.beat(host.chip.now + 900 * MILLISECOND)
    host.control("hold", 1)
    host.control("configure", 1)
    host.command("ParameterWrite", 1, parameter="feedback.period", value=1)
    host.control("enable", 1)
    host.run(20)
    answer = host.command("MoveBeta", 1, target=0.25, duration=0.3)
    # It leaves at the next tick or the one after.
    expect(
        300 <= answer["detail"] <= 302, f"the move takes other than 300 ticks: {answer}"
    )
    host.run(360)
    (_, started), *_ = host.heard("Started_1")
    reports = host.heard("Feedback_1")
    places = [fields["position"] for _, fields in reports]
    expect(places == sorted(places), "the axis moves backwards")
    expect(
        places[0] == 0 and places[-1] == 0.25, f"from {places[0]} to {places[-1]} turn"
    )
    last = reports[-1][1]
    expect(
        last["velocity"] == 0 and not last["moving"], f"the axis does not rest: {last}"
    )
    begin = next(n for n, place in enumerate(places) if place > 0) - 1
    end = places.index(0.25)
    expect(295 <= end - begin <= 300, f"the move takes {end - begin} reports")
    middle = (begin + end) // 2
    expect(abs(places[middle] - 0.125) < 0.0025, f"half-way it is at {places[middle]}")
    fastest = max(fields["velocity"] for _, fields in reports)
    expect(1.3 < fastest * 0.3 / 0.25 < 2.3, f"the fastest is {fastest} turn/s")
    expect(0 < started["time"] < host.chip.now / 1e9, f"it started at {started}")

    # The answers at the beginning are before it on the bus; later only the other axes' frames may be.
    off = unsteadiness([at for at, _ in reports[begin + 5 : end]])
    measured(
        f"{EMULATED} reports of 1 kHz come off by", f"{off // 1000} us", "< 300 us"
    )
    expect(off < 300_000, "the axis does not report at 1 kHz")
    healthy(host, "operation enabled", axes=[1])
    expect(is_lit(host.chip), "the LED does not blink")


def keeps_up(host):
    """With the shortest frames, one after the other for 30 ms, none is lost while it plans an s-curve."""
    host.beat(host.chip.now + 900 * MILLISECOND)
    host.listen()
    for _ in range(250):
        host.send("EmergencyStop_63")
    host.send("MoveSCurve_1", target=0, duration=0.5, sequence=host.next_sequence())
    for _ in range(250):
        host.send("EmergencyStop_63")
    host.run(600)
    expect(len(host.heard("EmergencyStop_63")) == 500, "the bus was not full")
    healthy(host, "operation enabled", axes=[1])
    place = host.heard("Feedback_1")[-1][1]["position"]
    expect(place == 0, f"the axis is at {place} and not where it was sent")
    host.control("disable", 1)
    host.run(200)
    healthy(host, "switch on disabled")


def follows(host):
    """SYNCs that tell another time move the ticks to just before that time's whole milliseconds."""
    chip = host.chip
    ahead = 5 * SECOND + 400_000
    begin = chip.now
    for number in range(150):
        host.send_sync(begin + number * 3_600_000, number % 256, ahead)
    host.run(600)
    host.listen()
    host.run(100)
    phases = [(at + ahead + TICK_LEAD) % MILLISECOND for at, _ in host.heard("Feedback_1")]
    expect(len(phases) >= 99, f"{len(phases)} reports came in 100 ms")
    latest = max(phases)
    measured(
        f"{EMULATED} reports after the bus time of their ticks",
        f"{min(phases) // 1000} to {latest // 1000} us",
        "135 to 500 us",
    )
    # The clock is late by a SYNC's time on the bus, and the report by its own, 135 us each at most.
    expect(
        135_000 <= min(phases) and latest < 500_000,
        "ticks are not just before whole milliseconds",
    )


def saves(host):
    """Which drive axis 2 has is kept over a reset, and it is spoken to on the drives' bus."""
    chip = host.chip
    host.beat(chip.now + 500 * MILLISECOND)
    expect(not chip.drives.bus.log, "simulated drives are spoken to")
    host.control("hold", 2)
    host.control("configure", 2)
    host.command("ParameterWrite", 2, parameter="drive.kind", value=1)
    begin = chip.now
    host.control("save", 2, patience=200)
    measured(f"{EMULATED} saving", f"{(chip.now - begin) // 1000} us", "< 100 ms")
    expect(chip.flash.erased == 1, f"{chip.flash.erased} pages were erased")
    expect(len(chip.resets) == 1, "saving resets the chip")

    chip.press_reset()
    host.listen()
    odrive = Odrive(chip.drives.bus, 2)
    odrive.live(chip.now, chip.now + 2000 * MILLISECOND)
    host.run(300)
    healthy(host, "switch on disabled")
    expect(odrive.setpoints, "an ODrive is not spoken to")
    host.beat(chip.now + 1700 * MILLISECOND)
    host.control("hold", 2)
    host.control("enable", 2)
    host.run(300)
    healthy(host, "operation enabled", axes=[2])
    odrive.setpoints.clear()
    host.command("MoveBeta", 2, target=0.125, duration=0.2)
    host.run(250)
    expect(odrive.position == 0.125, f"the ODrive was led to {odrive.position}")
    off = unsteadiness([at for at, _ in odrive.setpoints])
    measured(
        f"{EMULATED} setpoints of 1 kHz come off by", f"{off // 1000} us", "< 300 us"
    )
    expect(off < 300_000, "the drive does not get a setpoint each millisecond")
    healthy(host, "operation enabled", axes=[2])
    return odrive


def forgets(host, odrive):
    """A drive that was unplugged for 35 ms of a move is not told old setpoints then."""
    bus = host.chip.drives.bus
    host.command("MoveBeta", 2, target=-0.125, duration=0.4)
    host.run(180)
    (_, before), (_, last) = odrive.setpoints[-2:]
    bus.has_peer = False
    host.run(35)
    bus.has_peer = True
    odrive.setpoints.clear()
    host.run(200)
    _, first = odrive.setpoints[0]
    old = 35 - (last - first) / (before - last)
    measured(
        f"{EMULATED} a setpoint after a drive was away is old by",
        f"{old:.1f} ms",
        "< 15 ms",
    )
    # Up to 5 ms in the hardware once that is full, and 5 before it has room.
    expect(old < 15, "a drive that is there again is told an old place")
    expect(odrive.position == -0.125, f"the ODrive was led to {odrive.position}")
    healthy(host, "operation enabled", axes=[2])


def comes_back(host):
    """From bus-off, after a wait; and from a bus without a peer, where no frame is acknowledged."""
    chip = host.chip
    host.listen()
    begin = chip.now
    chip.host.go_bus_off()
    host.run(300)
    first = host.bus.log[host.begin][0] - begin
    measured(
        f"{EMULATED} back from bus-off after", f"{first // 1000} us", "10 to 20 ms"
    )
    expect(
        10 * MILLISECOND < first < 20 * MILLISECOND,
        "the node is not back from bus-off in time",
    )
    healthy(host, "fault", fault="bus_off", bus_off=1)

    host.bus.has_peer = False
    host.run(300)
    host.bus.has_peer = True
    host.listen()
    host.run(300)
    healthy(host, "fault", fault="bus_off", bus_off=1)


def without_slots(image, database):
    """A chip whose flash is one bank: the node runs, and says that it cannot save."""
    chip = Chip(image, CHIP_ID)
    chip.flash.make_one_bank()
    host = Host(chip, database)
    chip.power_on()
    host.run(300)
    healthy(host, "switch on disabled")
    host.control("hold", 1)
    try:
        host.control("save", 1, patience=200)
    except Refused as refusal:
        expect(
            refusal.reason == "save_failed", f"a save is refused otherwise: {refusal}"
        )
    else:
        raise AssertionError("a save is accepted that cannot be")
    expect(len(chip.resets) == 1, f"the chip was reset: {chip.resets}")


def main():
    """All of it, with one chip."""
    image, version, database = sys.argv[1:]
    database = cantools.database.load_file(database)
    chip = Chip(image, CHIP_ID)
    host = Host(chip, database)
    boots(host)
    scans(host, version)
    moves(host)
    keeps_up(host)
    follows(host)
    odrive = saves(host)
    forgets(host, odrive)
    comes_back(host)
    expect(len(chip.resets) == 2, f"the chip was reset: {chip.resets}")
    gap = chip.watchdog.longest
    measured(
        f"{EMULATED} longest between two feeds of the watchdog",
        f"{gap // 1000} us",
        "< 20 ms",
    )
    used, size = chip.stack()
    measured(f"{EMULATED} stack", f"{used} of {size} B", "< 3/4")
    expect(4 * used < 3 * size, f"the stack takes {used} of {size} bytes")
    without_slots(image, database)


if __name__ == "__main__":
    main()
