//! Colours, dashes and sizes.
//!
//! The drawing library writes colours as numbers. Each one below is used for one thing only, so what
//! it cannot draw (dashes, another colour on a dark page) is put in by the number afterwards.

use plotters::prelude::*;

/// The library draws on whole points only, so there are 4 to each pixel.
pub(super) const SCALE: i32 = 4;

pub(super) const TEXT_SIZE: i32 = 13 * SCALE;

/// Width of a letter of ordinary text as a share of its size: rather too much than too little, for
/// what is wider runs into what is beside it.
pub(super) const LETTER: f64 = 0.56;

/// Thin enough for twelve series in one chart.
pub(super) const LINE_WIDTH: u32 = 6;

/// Of a dot.
pub(super) const RADIUS: i32 = 2 * SCALE;

pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x23);
pub(super) const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDE);
pub(super) const FRAME: RGBColor = RGBColor(0x99, 0x99, 0x9A);
pub(super) const LEVEL: RGBColor = RGBColor(0xC0, 0x20, 0x21);

const LEVEL_DASHES: &str = "24 16";

/// How a picture's elements say that they show its numbers.
pub(super) const SERIES: &str = "class=\"series\" ";

/// The colours that a page's style sheet calls by name.
const ROLES: [(&str, RGBColor); 4] = [
    ("ink", INK),
    ("grid", GRID),
    ("frame", FRAME),
    ("level", LEVEL),
];

/// How a series looks: its colour on white, on a dark page, and its dashes in points; none for a
/// line without a gap.
struct Look {
    on_white: RGBColor,
    on_dark: RGBColor,
    dashes: &'static str,
}

const fn look(on_white: u32, on_dark: u32, dashes: &'static str) -> Look {
    Look {
        on_white: colour_of(on_white),
        on_dark: colour_of(on_dark),
        dashes,
    }
}

const fn colour_of(number: u32) -> RGBColor {
    let [_, red, green, blue] = number.to_be_bytes();
    RGBColor(red, green, blue)
}

/// Six colours that people who see fewer colours can tell apart too: those of Okabe and Ito (2008),
/// the light ones darker for a white page. The same six again with dots, so that no two of twelve
/// differ by colour alone.
const LOOKS: [Look; 12] = [
    look(0x00_72_B2, 0x56_B4_E9, ""),
    look(0xD5_5E_00, 0xFF_8A_3C, "36 12"),
    look(0x00_8F_68, 0x2C_C9_9B, "16 10"),
    look(0xB2_50_8B, 0xE3_9A_C4, "40 10 8 10"),
    look(0x8A_69_00, 0xE6_C0_4A, "60 12"),
    look(0x55_60_6E, 0xB4_BE_CC, "28 8 8 8 8 8"),
    look(0x00_72_B3, 0x56_B4_EA, "6 10"),
    look(0xD5_5E_01, 0xFF_8A_3D, "36 12 6 12"),
    look(0x00_8F_69, 0x2C_C9_9C, "16 10 4 10"),
    look(0xB2_50_8C, 0xE3_9A_C5, "40 20"),
    look(0x8A_69_01, 0xE6_C0_4B, "10 20"),
    look(0x55_60_6F, 0xB4_BE_CD, "20 20"),
];

/// The colour of a series.
pub(super) fn colour(index: usize) -> RGBColor {
    LOOKS[index % LOOKS.len()].on_white
}

pub(super) fn text_style() -> TextStyle<'static> {
    // The library asks for 1.24 times the size of the letters.
    let size = f64::from(TEXT_SIZE) * 1.24;
    TextStyle::from(("sans-serif", size).into_font()).color(&INK)
}

/// The colour as it is written in SVG.
fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The same picture with dashes, and with what shows the numbers in the class `series`, apart from what
/// is around it.
pub(super) fn dressed(svg: &str) -> String {
    let mut svg = svg.to_owned();
    let mut dress = |plain: String, dress: String| {
        if !dress.is_empty() {
            svg = svg.replace(&plain, &format!("{dress}{plain}"));
        }
    };
    let line = |colour| format!("fill=\"none\" opacity=\"1\" stroke=\"{}\"", hex(colour));
    let dashes = |dashes: &str| match dashes {
        "" => String::new(),
        dashes => format!("stroke-dasharray=\"{dashes}\" "),
    };
    dress(line(LEVEL), dashes(LEVEL_DASHES));
    for look in &LOOKS {
        let colour = look.on_white;
        // The lines of a legend are thicker, and its dots are larger.
        let curve = format!("{} stroke-width=\"{LINE_WIDTH}\"", line(colour));
        let filled = format!("opacity=\"1\" fill=\"{}\"", hex(colour));
        dress(curve, SERIES.to_owned());
        dress(format!("r=\"{RADIUS}\" {filled}"), SERIES.to_owned());
        dress(format!("{filled} stroke=\"none\"/>"), SERIES.to_owned());
        dress(line(colour), dashes(look.dashes));
    }
    svg
}

/// The rules by which a chart's fixed colours become those of a page, light or dark.
pub(super) fn rules() -> String {
    let rule = |from: RGBColor, to: &str| {
        let from = hex(from);
        ["stroke", "fill"]
            .map(|property| format!("svg [{property}=\"{from}\"] {{ {property}: {to}; }}\n"))
            .concat()
    };
    let roles: String = ROLES
        .iter()
        .map(|(name, colour)| rule(*colour, &format!("var(--{name})")))
        .collect();
    let dark: String = LOOKS
        .iter()
        .map(|look| rule(look.on_white, &hex(look.on_dark)))
        .collect();
    format!("{roles}@media (prefers-color-scheme: dark) {{\n{dark}}}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of two colours after the Web Content Accessibility Guidelines 2.2, 1 to 21.
    fn contrast(a: RGBColor, b: RGBColor) -> f64 {
        let luminance = |RGBColor(red, green, blue): RGBColor| {
            let [red, green, blue] = [red, green, blue].map(|part| {
                let part = f64::from(part) / 255.0;
                if part <= 0.040_45 {
                    part / 12.92
                } else {
                    ((part + 0.055) / 1.055).powf(2.4)
                }
            });
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn series_stand_out_from_both_grounds_and_no_two_look_alike() {
        // The grounds of report.css.
        let (white, dark) = (colour_of(0xFF_FF_FF), colour_of(0x15_18_1B));
        for (index, look) in LOOKS.iter().enumerate() {
            assert!(contrast(look.on_white, white) >= 3.0, "{index} on white");
            assert!(contrast(look.on_dark, dark) >= 3.0, "{index} on dark");
            for other in &LOOKS[..index] {
                assert_ne!(look.on_white, other.on_white);
                assert_ne!(look.dashes, other.dashes, "{index}");
            }
        }
    }
}
