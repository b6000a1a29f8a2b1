//! One run of a table: its columns and samples, and the curve that they make.

use super::columns::Column;
use crate::curve::{Channel, Curve, Segment};
use crate::fault::{Fault, LARGEST};
use crate::text::clock::Clock;
use crate::text::fields::value;
use crate::text::lines::Line;
use crate::text::units::Quantity;

/// Columns that must not have an empty cell.
const NEEDED: &[&str] = &["time", "depth", "travel", "force", "tool_gap"];
/// Known names that begin a run: a second one belongs to a second run.
const OF_RUN: &[&str] = &["time", "depth", "travel", "force", "tool_gap"];
/// What to do about a bad cell.
const REMEDY: &str = "give every sample a finite number, or leave the sample out";
/// Part of the largest force above which, and below which, travels are compared.
const PRESSED: [f64; 2] = [0.5, 0.1];

/// One run while it is read.
pub(crate) struct Run {
    pub name: String,
    /// Place in the row, and what stands there.
    columns: Vec<(usize, Column)>,
    values: Vec<Vec<f64>>,
    /// The column `segment`, which divides the run.
    segment: Option<usize>,
    segments: Vec<Segment>,
    clock: Clock,
    /// Columns of text, which are not kept.
    texts: Vec<usize>,
}

/// The columns of each run of a table: a second time, force or length begins the next one.
pub(crate) fn divided(columns: Vec<Column>, above: &[String]) -> Vec<Run> {
    let mut groups: Vec<Vec<(usize, Column)>> = vec![Vec::new()];
    for (k, column) in columns.into_iter().enumerate() {
        let last = groups.last().map_or(&[][..], Vec::as_slice);
        let is_repeated = OF_RUN.contains(&column.base.as_str())
            && last.iter().any(|(_, other)| other.base == column.base);
        if is_repeated {
            groups.push(Vec::new());
        }
        if let Some(group) = groups.last_mut() {
            group.push((k, column));
        }
    }
    let is_several = groups.len() > 1;
    let mut runs: Vec<Run> = groups.into_iter().map(Run::new).collect();
    if is_several {
        for (k, run) in runs.iter_mut().enumerate() {
            let own = run.columns.iter().find_map(|(at, _)| above.get(*at));
            run.name = own.map(|name| name.trim().to_string()).unwrap_or_default();
            if run.name.is_empty() {
                run.name = format!("run {}", k + 1);
            }
        }
    }
    runs
}

impl Run {
    fn new(columns: Vec<(usize, Column)>) -> Run {
        Run {
            name: String::new(),
            values: vec![Vec::new(); columns.len()],
            segment: columns
                .iter()
                .position(|(_, column)| column.base == "segment"),
            columns,
            segments: Vec::new(),
            clock: Clock::default(),
            texts: Vec::new(),
        }
    }

    /// Whether it holds two of time, force and a length, as a run does.
    pub fn is_whole(&self) -> bool {
        let has = |name: &&&str| self.columns.iter().any(|(_, column)| column.base == **name);
        OF_RUN.iter().filter(has).count() >= 2
    }

    /// The first quantity of the run, for messages.
    pub fn first(&self) -> &str {
        let known = self
            .columns
            .iter()
            .find(|(_, column)| OF_RUN.contains(&column.base.as_str()));
        known.map_or("", |(_, column)| &column.base)
    }

    pub fn samples(&self) -> usize {
        self.values.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Takes back the last sample.
    pub fn drop_last(&mut self) {
        for values in &mut self.values {
            values.pop();
        }
    }

    pub fn width(&self) -> usize {
        self.columns.len()
    }

    /// Whether the row holds nothing of this run.
    pub fn is_past(&self, row: &[String]) -> bool {
        self.columns
            .iter()
            .all(|(at, _)| row.get(*at).is_none_or(String::is_empty))
    }

    /// Takes a row, or leaves the run as it was.
    pub fn take(&mut self, line: &Line, row: &[String]) -> Result<(), Fault> {
        let cell = |at: usize| row.get(at).map_or("", String::as_str);
        if self.samples() == 0 {
            let is_text = |(_, (at, column)): &(usize, &(usize, Column))| {
                column.unit.is_none() && !cell(*at).is_empty() && value(cell(*at)).is_err()
            };
            let texts = self.columns.iter().enumerate().filter(is_text);
            self.texts = texts.map(|(k, _)| k).collect();
        }
        let mut numbers = Vec::with_capacity(self.columns.len());
        for (k, (at, column)) in self.columns.iter().enumerate() {
            let field = cell(*at);
            let is_needed = NEEDED.contains(&column.base.as_str());
            if Some(k) == self.segment
                || self.texts.contains(&k)
                || (field.is_empty() && !is_needed)
            {
                numbers.push(f64::NAN);
                continue;
            }
            // Programs write the largest number there is where they computed nothing.
            if column.quantity().is_none()
                && field
                    .parse()
                    .is_ok_and(|number: f64| number.abs() > LARGEST)
            {
                numbers.push(f64::NAN);
                continue;
            }
            let problem = |problem| line.fault(format!("{}: {problem}", column.base), REMEDY);
            numbers.push(value(field).map_err(problem)?);
        }
        let time = self
            .columns
            .iter()
            .position(|(_, column)| column.base == "time");
        if let (Some(time), None) = (time, self.segment) {
            self.clock.push(line.number, numbers[time])?;
        }
        if let Some(k) = self.segment {
            self.divide(cell(self.columns[k].0));
        }
        self.values
            .iter_mut()
            .zip(numbers)
            .for_each(|(column, number)| column.push(number));
        Ok(())
    }

    fn divide(&mut self, name: &str) {
        let at = self.samples();
        match self.segments.last_mut() {
            Some(last) if last.name == name => last.end = at + 1,
            _ => self.segments.push(Segment {
                name: name.to_string(),
                start: at,
                end: at + 1,
            }),
        }
    }

    /// Adds the channels to what the head said.
    pub fn finish(self, mut curve: Curve) -> Curve {
        curve.name = self.name;
        let mut asked = Vec::new();
        for (k, ((_, column), mut values)) in self.columns.into_iter().zip(self.values).enumerate()
        {
            let is_empty = column.base.is_empty() || values.iter().all(|value| value.is_nan());
            if Some(k) == self.segment || self.texts.contains(&k) || is_empty {
                continue;
            }
            if column.is_reversed {
                values.iter_mut().for_each(|value| *value = -*value);
            }
            if column.quantity().is_none()
                && let Some(unit) = column.unit
            {
                asked.push((unit.quantity, column.header.clone()));
            }
            curve.channels.push(match column.unit {
                Some(unit) => Channel::converted(&column.base, unit, values),
                None => Channel {
                    name: column.base.clone(),
                    unit: column.unit_text.clone(),
                    values,
                },
            });
        }
        curve.segments = self.segments;
        with_tool_travel(&mut curve);
        state_unknown(&mut curve, &asked);
        warn_of_signs(&mut curve);
        curve
    }
}

/// The travel of a tool whose gap is recorded.
fn with_tool_travel(curve: &mut Curve) {
    if curve.channel("travel_mm").is_some() {
        return;
    }
    let gap = curve
        .channel("tool_gap_mm")
        .map(|gap| gap.iter().map(|value| gap[0] - value).collect());
    curve
        .channels
        .extend(gap.map(|travel| Channel::named("travel", Quantity::Length, travel)));
}

/// What the columns leave open; `asked` are those whose name says nothing, which a user may name.
fn state_unknown(curve: &mut Curve, asked: &[(Quantity, String)]) {
    let which = |quantity: Quantity, key: &str| {
        let names: Vec<&str> = asked
            .iter()
            .filter(|(kind, _)| *kind == quantity)
            .map(|(_, header)| header.as_str())
            .collect();
        let first = names.first()?;
        let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
        Some(format!(
            ": which of {} is it? Name it: {key} = \"{first}\" under [recordings.columns] in study.toml, or --column \"{key}={first}\"; a minus before \
             the name turns the sign",
            names.join(", ")
        ))
    };
    let has = |name: &str| curve.channel(name).is_some();
    let mut unknown = Vec::new();
    if !has("time_s") {
        unknown.push("the time of the samples: rates and relaxation".to_string());
    }
    if !has("force_n") {
        unknown.push(format!(
            "the force{}",
            which(Quantity::Force, "force").unwrap_or_default()
        ));
    }
    if !has("depth_mm") {
        unknown.push("where contact begins: no column holds a depth from first touch".to_string());
        if !has("travel_mm")
            && let Some(which) = which(Quantity::Length, "travel")
        {
            unknown.push(format!("the travel{which}"));
        }
    }
    curve.unknown.extend(unknown);
}

/// Says where a force or a travel seems to count the other way than here.
fn warn_of_signs(curve: &mut Curve) {
    let Some(force) = curve.channel("force_n") else {
        return;
    };
    let (low, high) = force.iter().fold((0.0_f64, 0.0_f64), |(low, high), f| {
        (low.min(*f), high.max(*f))
    });
    let mut warnings = Vec::new();
    if -low > high {
        warnings.push(
            "the force is negative where it is largest; here pressing is positive: name its column with a minus before the name, force = \"-NAME\""
                .to_string(),
        );
    }
    let length = ["depth_mm", "travel_mm"]
        .into_iter()
        .find_map(|name| Some((name, curve.channel(name)?)));
    if let Some((name, length)) = length.filter(|_| high >= -low && high > 0.0) {
        let mean = |is_in: &dyn Fn(f64) -> bool| {
            let of_kind = force.iter().zip(length).filter(|(f, _)| is_in(**f));
            let (count, sum) = of_kind.fold((0, 0.0), |(count, sum), (_, length)| {
                (count + 1, sum + length)
            });
            (count > 0).then(|| sum / f64::from(count))
        };
        let [much, little] = [
            mean(&|f| f > PRESSED[0] * high),
            mean(&|f| f < PRESSED[1] * high),
        ];
        if much.zip(little).is_some_and(|(much, little)| much < little) {
            let name = name.trim_end_matches("_mm");
            warnings.push(format!(
                "the {name} falls where the force grows; here it grows into the sample: name its column with a minus before the name, {name} = \"-NAME\""
            ));
        }
    }
    curve.warnings.extend(warnings);
}
