//! The picture of a [`View`].

use super::nobody;
use super::view::{AxisRow, View};
use ratatui::Frame;
use ratatui::layout::{Alignment, Constraint, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Text};
use ratatui::widgets::{Cell, Paragraph, Row, Table};

const KEYS: &str = "q, Esc or Ctrl-C ends it; arrows, PageUp and PageDown scroll";

/// Lines of the titles.
const TITLES: u16 = 2;

/// Lines that the titles and an axis have however much the foot says.
const LEAST_TABLE: u16 = TITLES + 1;

/// One column.
struct Column {
    title: &'static str,
    width: u16,
    alignment: Alignment,
    words: fn(&AxisRow) -> String,
}

const fn left(title: &'static str, width: u16, words: fn(&AxisRow) -> String) -> Column {
    Column {
        title,
        width,
        alignment: Alignment::Left,
        words,
    }
}

const fn right(title: &'static str, width: u16, words: fn(&AxisRow) -> String) -> Column {
    Column {
        alignment: Alignment::Right,
        ..left(title, width, words)
    }
}

const AXIS: Column = right("axis", 4, |row| row.axis.to_string());
const POSITION: Column = right("position\nrad", 10, |row| number(row.position, 10));
const VELOCITY: Column = right("velocity\nrad/s", 8, |row| number(row.velocity, 8));
const HOLDER: Column = left("held\nby", 6, |row| row.holder.clone());
const BUS_OFF: Column = right("bus\noff", 3, |row| row.bus_off.to_string());
const ERROR_FRAMES: Column = right("error\nframes", 6, |row| row.error_frames.to_string());
const LOST: Column = right("lost", 4, |row| row.lost.to_string());

const COLUMNS: &[Column] = &[
    AXIS,
    left("state", 22, state),
    POSITION,
    VELOCITY,
    left("moving", 6, |row| moving(row).to_owned()),
    HOLDER,
    left("fault", 18, |row| fault(row).to_owned()),
    BUS_OFF,
    ERROR_FRAMES,
    LOST,
    right("rejected", 8, |row| row.rejected.to_string()),
];

/// The same on 80 columns: a state that says the fault, or that it moves.
const NARROW_COLUMNS: &[Column] = &[
    AXIS,
    left("state", 25, state_with_the_rest),
    POSITION,
    VELOCITY,
    HOLDER,
    BUS_OFF,
    ERROR_FRAMES,
    LOST,
    right("re-\njected", 6, |row| row.rejected.to_string()),
];

fn state(row: &AxisRow) -> String {
    match row.silence {
        Some(seconds) => format!("silent for {seconds:.0} s"),
        None => row.state.to_owned(),
    }
}

fn moving(row: &AxisRow) -> &'static str {
    match row.moving {
        Some(true) => "yes",
        Some(false) => "no",
        None => "",
    }
}

fn fault(row: &AxisRow) -> &'static str {
    row.fault.map_or("", |fault| fault.name())
}

fn state_with_the_rest(row: &AxisRow) -> String {
    match (row.silence, row.fault, row.moving) {
        (Some(_), _, _) => state(row),
        (None, Some(fault), _) => format!("fault: {}", fault.name()),
        (None, None, Some(true)) => format!("{}, moves", row.state),
        (None, None, _) => row.state.to_owned(),
    }
}

/// A number with as many decimals, up to four, as there is room for: it is never cut.
fn number(value: Option<f64>, width: usize) -> String {
    let Some(value) = value else {
        return String::from("-");
    };
    (0..=4)
        .rev()
        .map(|decimals| format!("{value:.decimals$}"))
        .find(|text| text.len() <= width)
        .unwrap_or_else(|| format!("{value:.1e}"))
}

/// Draws all of it.
pub fn draw(frame: &mut Frame, view: &View) {
    let area = frame.area();
    let foot = foot(view, area);
    let height = table_height(area.height, foot.len());
    let [upper, lower] = [
        Rect { height, ..area },
        Rect {
            y: area.y + height,
            height: area.height - height,
            ..area
        },
    ];
    if view.axes.is_empty() {
        frame.render_widget(Paragraph::new(nobody(&view.bus)), upper);
    } else {
        frame.render_widget(table(view, upper), upper);
    }
    frame.render_widget(Paragraph::new(foot), lower);
}

/// How many axes are shown at once, and the last of which the list can begin with.
pub fn page(view: &View, area: Rect) -> (usize, usize) {
    let height = table_height(area.height, foot_words(view, area.width).len());
    let shown = usize::from(height.saturating_sub(TITLES)).max(1);
    (shown, view.axes.len().saturating_sub(shown))
}

fn table_height(height: u16, foot: usize) -> u16 {
    let foot = u16::try_from(foot).unwrap_or(u16::MAX);
    height.saturating_sub(foot).max(height.min(LEAST_TABLE))
}

fn table(view: &View, area: Rect) -> Table<'static> {
    let columns = columns(area.width);
    let shown = usize::from(area.height.saturating_sub(TITLES));
    let last_first = view.axes.len().saturating_sub(shown);
    let rows = view
        .axes
        .iter()
        .skip(view.first.min(last_first))
        .take(shown);
    let rows = rows.map(|row| {
        let cells = columns
            .iter()
            .map(|column| cell((column.words)(row), column));
        Row::new(cells).style(style(row, view.has_colours))
    });
    let titles = columns
        .iter()
        .map(|column| cell(column.title.to_owned(), column));
    let titles = Row::new(titles).height(TITLES);
    Table::new(
        rows,
        columns
            .iter()
            .map(|column| Constraint::Length(column.width)),
    )
    .header(titles.style(Style::new().add_modifier(Modifier::BOLD)))
    .column_spacing(1)
}

/// The columns that there is room for.
fn columns(width: u16) -> &'static [Column] {
    let wide = widths(COLUMNS) <= width;
    let columns = if wide { COLUMNS } else { NARROW_COLUMNS };
    let fitting = (0..=columns.len()).rev();
    fitting
        .map(|count| &columns[..count])
        .find(|columns| widths(columns) <= width)
        .unwrap_or_default()
}

/// How wide columns are, with a space between two.
fn widths(columns: &[Column]) -> u16 {
    let widths = columns.iter().map(|column| column.width + 1);
    widths.sum::<u16>().saturating_sub(1)
}

fn cell(words: String, column: &Column) -> Cell<'static> {
    Cell::from(Text::from(words).alignment(column.alignment))
}

/// What must be seen at a glance differs without colours too, but for what moves: that has a word.
fn style(row: &AxisRow, has_colours: bool) -> Style {
    let (modifier, colour) = if row.silence.is_some() {
        (Modifier::DIM, None)
    } else if row.fault.is_some() {
        (Modifier::BOLD, Some(Color::Red))
    } else if row.moving == Some(true) {
        (Modifier::empty(), Some(Color::Green))
    } else {
        (Modifier::empty(), None)
    };
    let style = Style::new().add_modifier(modifier);
    match colour {
        Some(colour) if has_colours => style.fg(colour),
        _ => style,
    }
}

fn foot(view: &View, area: Rect) -> Vec<Line<'static>> {
    let lines = foot_words(view, area.width).into_iter();
    lines.map(Line::from).collect()
}

/// The foot's lines.
fn foot_words(view: &View, width: u16) -> Vec<String> {
    let mut bus = format!("{}: {} axes heard", view.bus, view.axes.len());
    if let Some(rate) = view.rate {
        bus.push_str(&format!(", {rate:.0} frames per second"));
    }
    let fault = view.axes.iter().find_map(|row| {
        let fault = row.fault?;
        let [name, cause, cure] = [fault.name(), fault.cause(), fault.cure()];
        Some(format!("axis {}: {name}: {cause}; {cure}", row.axis))
    });
    let complaint = view.complaint.as_ref().map(|words| format!("bus: {words}"));
    let paragraphs = [Some(bus), complaint, fault, Some(KEYS.to_owned())];
    let paragraphs = paragraphs.iter().flatten();
    paragraphs
        .flat_map(|words| wrap(words, usize::from(width)))
        .collect()
}

/// Lines of up to `width` characters, broken between words where a word is no longer than that.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests;
