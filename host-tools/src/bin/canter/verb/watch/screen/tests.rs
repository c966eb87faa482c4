use super::*;
use canter_shared::axis::fault::Fault;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;

fn axis(axis: u8) -> AxisRow {
    AxisRow {
        axis,
        state: "operation enabled",
        position: Some(-1.5),
        velocity: Some(0.0),
        moving: Some(false),
        holder: String::from("0xbeef"),
        ..AxisRow::default()
    }
}

fn moving() -> AxisRow {
    AxisRow {
        velocity: Some(2.25),
        moving: Some(true),
        ..axis(1)
    }
}

fn faulted() -> AxisRow {
    AxisRow {
        state: "fault",
        fault: Some(Fault::HostTimeout),
        holder: String::from("nobody"),
        bus_off: 1,
        error_frames: 255,
        lost: 3,
        rejected: 4,
        ..axis(2)
    }
}

fn silent() -> AxisRow {
    AxisRow {
        silence: Some(12.3),
        moving: Some(true),
        ..axis(63)
    }
}

fn view(axes: &[AxisRow]) -> View {
    View {
        bus: String::from("socketcan vcan0"),
        axes: axes.to_vec(),
        rate: Some(601.7),
        ..View::default()
    }
}

fn drawn(view: &View, width: u16, height: u16) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a terminal");
    terminal.draw(|frame| draw(frame, view)).expect("drawn");
    terminal.backend().buffer().clone()
}

fn lines(buffer: &Buffer) -> Vec<String> {
    let width = usize::from(buffer.area.width);
    let lines = buffer.content.chunks(width);
    lines
        .map(|line| line.iter().map(|cell| cell.symbol()).collect::<String>())
        .map(|line| line.trim_end().to_owned())
        .collect()
}

#[test]
fn a_moving_a_faulted_and_a_silent_axis_show_what_they_are() {
    let view = view(&[moving(), faulted(), silent()]);
    let shown = lines(&drawn(&view, 120, 12));
    let wanted = [
        "axis state                    position velocity moving held   fault              bus  error lost rejected",
        "                                   rad    rad/s        by                        off frames",
        "   1 operation enabled         -1.5000   2.2500 yes    0xbeef                      0      0    0        0",
        "   2 fault                     -1.5000   0.0000 no     nobody host_timeout         1    255    3        4",
        "  63 silent for 12 s           -1.5000   0.0000 yes    0xbeef                      0      0    0        0",
        "",
        "",
        "",
        "socketcan vcan0: 3 axes heard, 602 frames per second",
        "axis 2: host_timeout: the session that held the axis sent no heartbeat for host.timeout; look for a host that crashed,",
        "hung or lost the bus, then clear and enable",
        "q, Esc or Ctrl-C ends it; arrows, PageUp and PageDown scroll",
    ];
    assert_eq!(shown, wanted, "{shown:#?}");
}

#[test]
fn eighty_columns_have_room_for_all_of_it() {
    let mut axes = [moving(), faulted(), silent(), axis(7)];
    axes[1].fault = Some(Fault::DriveUndervoltage);
    axes[3].state = "not ready to switch on";
    axes[3].position = Some(-6283.185);
    let shown = lines(&drawn(&view(&axes), 80, 24));
    let wanted = [
        "axis state                       position velocity held   bus  error lost    re-",
        "                                      rad    rad/s by     off frames      jected",
        "   1 operation enabled, moves     -1.5000   2.2500 0xbeef   0      0    0      0",
        "   2 fault: drive_undervoltage    -1.5000   0.0000 nobody   1    255    3      4",
        "  63 silent for 12 s              -1.5000   0.0000 0xbeef   0      0    0      0",
        "   7 not ready to switch on    -6283.1850   0.0000 0xbeef   0      0    0      0",
    ];
    assert_eq!(shown[..wanted.len()], wanted, "{shown:#?}");
}

#[test]
fn colours_are_for_who_wants_them_and_never_all_that_tells() {
    let mut view = view(&[moving(), faulted(), silent()]);
    for has_colours in [true, false] {
        view.has_colours = has_colours;
        let buffer = drawn(&view, 120, 12);
        let cell = |line| &buffer[(3, line)];
        let wanted = if has_colours {
            [Color::Green, Color::Red, Color::Reset]
        } else {
            [Color::Reset; 3]
        };
        assert_eq!([2, 3, 4].map(|line| cell(line).fg), wanted);
        assert_eq!(cell(3).modifier, Modifier::BOLD);
        assert_eq!(cell(4).modifier, Modifier::DIM);
        if !has_colours {
            let plain =
                |cell: &ratatui::buffer::Cell| cell.fg == Color::Reset && cell.bg == Color::Reset;
            assert!(buffer.content.iter().all(plain));
        }
    }
}

#[test]
fn nobody_is_waited_for() {
    let mut view = view(&[]);
    view.complaint = Some(String::from("12 received frames lost"));
    let shown = lines(&drawn(&view, 80, 6));
    assert_eq!(shown[0], "no axis is heard on socketcan vcan0 yet");
    assert_eq!(
        shown[3],
        "socketcan vcan0: 0 axes heard, 602 frames per second"
    );
    assert_eq!(shown[4], "bus: 12 received frames lost");
}

#[test]
fn more_axes_than_lines_scroll_to_the_last_one() {
    let axes: Vec<_> = (1..=63).map(axis).collect();
    let mut view = view(&axes);
    let (shown, last) = page(&view, Rect::new(0, 0, 80, 24));
    assert_eq!((shown, last), (20, 43));
    for (first, ids) in [(0, 1..=20), (5, 6..=25), (43, 44..=63), (1_000, 44..=63)] {
        view.first = first;
        let lines = lines(&drawn(&view, 80, 24));
        let heads = lines[2..22].iter().map(|line| line[..4].trim().to_owned());
        let wanted: Vec<_> = ids.map(|id| id.to_string()).collect();
        assert_eq!(heads.collect::<Vec<_>>(), wanted, "{first}");
    }
}

#[test]
fn a_terminal_of_any_size_is_drawn_on() {
    let mut axes: Vec<_> = (1..=60).map(axis).collect();
    axes.extend([moving(), faulted(), silent()]);
    for axes in [&[][..], &axes] {
        let mut view = view(axes);
        view.first = 30;
        view.complaint = Some("word".repeat(100));
        for (width, height) in [
            (0, 0),
            (1, 1),
            (3, 2),
            (10, 3),
            (40, 5),
            (80, 24),
            (500, 200),
        ] {
            drawn(&view, width, height);
            page(&view, Rect::new(0, 0, width, height));
        }
    }
}

#[test]
fn numbers_give_up_decimals_before_they_are_cut() {
    for (value, text) in [
        (0.12345, "0.1235"),
        (-20.0, "-20.0000"),
        (-200.5, "-200.500"),
        (1e7, "10000000"),
        (-1e9, "-1.0e9"),
    ] {
        assert_eq!(number(Some(value), 8), text);
    }
    assert_eq!(number(None, 8), "-");
}
