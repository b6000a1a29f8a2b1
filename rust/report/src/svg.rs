//! Writing of SVG: shapes with two decimals, text escaped.

use std::fmt::Write;

/// Text safe inside an element or a quoted attribute of HTML and SVG.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // Control characters are not allowed in XML.
            letter if letter.is_control() && letter != '\n' && letter != '\t' => safe.push(' '),
            letter => safe.push(letter),
        }
    }
    safe
}

/// A figure being drawn.
pub struct Svg {
    width: f64,
    height: f64,
    label: String,
    body: String,
}

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// What a text is, and with that its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    Tick,
    Axis,
    Legend,
    Title,
}

impl Svg {
    /// An empty figure of a size, px; `label` tells it to those who cannot see it.
    pub fn new(width: f64, height: f64, label: &str) -> Svg {
        Svg {
            width,
            height,
            label: escaped(label),
            body: String::new(),
        }
    }

    /// A filled rectangle.
    pub fn rect(&mut self, corner: [f64; 2], size: [f64; 2], fill: &str) {
        let ([x, y], [width, height]) = (corner.map(short), size.map(short));
        self.put(format_args!(
            "<rect x='{x}' y='{y}' width='{width}' height='{height}' fill='{fill}'/>"
        ));
    }

    /// A rectangle through which what lies below shows.
    pub fn shade(&mut self, corner: [f64; 2], size: [f64; 2], fill: &str) {
        let ([x, y], [width, height]) = (corner.map(short), size.map(short));
        self.put(format_args!(
            "<rect x='{x}' y='{y}' width='{width}' height='{height}' fill='{fill}' fill-opacity='0.45'/>"
        ));
    }

    /// An outlined rectangle.
    pub fn frame(&mut self, corner: [f64; 2], size: [f64; 2], stroke: &str) {
        let ([x, y], [width, height]) = (corner.map(short), size.map(short));
        self.put(format_args!(
            "<rect x='{x}' y='{y}' width='{width}' height='{height}' fill='none' stroke='{stroke}'/>"
        ));
    }

    /// A line; `style` holds further attributes.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], style: &str) {
        let ([x, y], [u, v]) = (from.map(short), to.map(short));
        self.put(format_args!(
            "<line x1='{x}' y1='{y}' x2='{u}' y2='{v}' {style}/>"
        ));
    }

    /// An open line through points; NaN parts it.
    pub fn polyline(&mut self, points: &[[f64; 2]], style: &str) {
        for part in points.split(|point| point.iter().any(|part| part.is_nan())) {
            if part.len() < 2 {
                continue;
            }
            let mut path = String::with_capacity(12 * part.len());
            for (k, [x, y]) in part.iter().enumerate() {
                let letter = if k == 0 { 'M' } else { 'L' };
                let _ = write!(path, "{letter}{} {}", short(*x), short(*y));
            }
            self.put(format_args!("<path d='{path}' fill='none' {style}/>"));
        }
    }

    /// Dots of one radius and color.
    pub fn dots(&mut self, points: &[[f64; 2]], radius: f64, fill: &str) {
        let finite = points
            .iter()
            .filter(|point| point.iter().all(|part| part.is_finite()));
        let mut path = String::new();
        for [x, y] in finite {
            let _ = write!(path, "M{} {}h0", short(*x), short(*y));
        }
        if !path.is_empty() {
            let width = short(2.0 * radius);
            self.put(format_args!(
                "<path d='{path}' stroke='{fill}' stroke-width='{width}' stroke-linecap='round' fill='none'/>"
            ));
        }
    }

    /// A ring.
    pub fn ring(&mut self, center: [f64; 2], radius: f64, stroke: &str) {
        let ([x, y], radius) = (center.map(short), short(radius));
        self.put(format_args!(
            "<circle cx='{x}' cy='{y}' r='{radius}' fill='none' stroke='{stroke}' stroke-width='1.6'/>"
        ));
    }

    /// A text.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, kind: Type, text: &str) {
        let ([x, y], anchor, look) = (at.map(short), anchor.name(), kind.look());
        let text = escaped(text);
        self.put(format_args!(
            "<text x='{x}' y='{y}' text-anchor='{anchor}' {look}>{text}</text>"
        ));
    }

    /// A text that reads upward.
    pub fn text_up(&mut self, at: [f64; 2], kind: Type, text: &str) {
        let ([x, y], text, look) = (at.map(short), escaped(text), kind.look());
        self.put(format_args!(
            "<text transform='translate({x} {y}) rotate(-90)' text-anchor='middle' {look}>{text}</text>"
        ));
    }

    /// The element.
    pub fn finish(self) -> String {
        let (width, height) = (short(self.width), short(self.height));
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='{width}' height='{height}' viewBox='0 0 {width} {height}' font-family='Inter,Segoe UI,Roboto,Helvetica Neue,Arial,sans-serif' role='img' aria-label='{}'>{}</svg>",
            self.label, self.body
        )
    }

    fn put(&mut self, shape: std::fmt::Arguments) {
        let _ = self.body.write_fmt(shape);
        self.body.push('\n');
    }
}

impl Type {
    /// Attributes, so that a figure looks the same where the page's style does not reach.
    fn look(self) -> &'static str {
        match self {
            Type::Tick => "font-size='11' fill='#39424a'",
            Type::Axis => "font-size='12' fill='#1c2126'",
            Type::Legend => "font-size='11.5' fill='#1c2126'",
            Type::Title => "font-size='12.5' font-weight='600' fill='#1c2126'",
        }
    }
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// Two decimals at most.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}
