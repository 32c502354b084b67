//! Parameters by name: of a row, or of the description of the pack.

use std::fmt::{self, Display};
use std::str::FromStr;

use toml::Value;
use voltstep_bms::manage::{BmsParams, Description};
use voltstep_bms::protect::{Id, Row};
use voltstep_bms::{ParamError, Real};

/// A parameter, and what becomes of it: `CellVoltage(High,Msl).threshold-=0.02`,
/// `sheet.actuators.break_a=200`.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    name: String,
    to: To,
    value: f64,
}

/// How it is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum To {
    Value,
    Further,
}

/// Why a parameter is not changed.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum ChangeError {
    /// Not of that form.
    #[error("`{0}`: write NAME=VALUE, NAME+=VALUE or NAME-=VALUE")]
    Form(String),
    /// No row and no parameter of that name.
    #[error("`{0}` names no number; {1}")]
    Name(String, String),
    /// The value is refused.
    #[error("`{0}`: {1}")]
    Refused(String, String),
}

impl FromStr for Change {
    type Err = ChangeError;

    fn from_str(text: &str) -> Result<Self, ChangeError> {
        let form = || ChangeError::Form(text.to_owned());
        let (name, value) = text.split_once('=').ok_or_else(form)?;
        let value: f64 = value.trim().parse().map_err(|_| form())?;
        let (name, to, sign) = match (name.strip_suffix('+'), name.strip_suffix('-')) {
            (Some(name), _) => (name, To::Further, 1.0),
            (_, Some(name)) => (name, To::Further, -1.0),
            _ => (name, To::Value, 1.0),
        };
        let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
        if name.is_empty() || !value.is_finite() {
            return Err(form());
        }
        Ok(Self { name, to, value: sign * value })
    }
}

impl Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.to {
            To::Value => write!(f, "{}={}", self.name, self.value),
            To::Further if self.value < 0.0 => write!(f, "{}-={}", self.name, -self.value),
            To::Further => write!(f, "{}+={}", self.name, self.value),
        }
    }
}

impl Change {
    fn of(&self, before: f64) -> f64 {
        match self.to {
            To::Value => self.value,
            To::Further => before + self.value,
        }
    }

    fn refused(&self, why: impl ToString) -> ChangeError {
        ChangeError::Refused(self.name.clone(), why.to_string())
    }

    /// A whole number of a row, from 0 to the largest of its type.
    fn whole<T: TryFrom<i64> + Into<f64>>(&self, before: T) -> Result<T, ChangeError> {
        let value = self.of(before.into()).round();
        #[expect(clippy::cast_possible_truncation, reason = "saturates, and is refused then")]
        T::try_from(value as i64).map_err(|_| self.refused(format!("{value} is no count")))
    }
}

/// The description with every change: first those of parameters, from which all rows follow, then
/// those of single rows.
pub(super) fn applied(params: BmsParams, changes: &[Change]) -> Result<Description, ChangeError> {
    let mut value =
        Value::try_from(params).map_err(|e| ChangeError::Name(String::new(), e.to_string()))?;
    let of_row = |change: &&Change| row_of(&change.name).is_some();
    let (rows, others): (Vec<&Change>, Vec<_>) = changes.iter().partition(of_row);
    for change in &others {
        let place = number_in(&mut value, &change.name)?;
        set(place, change)?;
    }
    let last = |error: String| match others.last() {
        Some(change) => change.refused(error),
        None => ChangeError::Name(String::new(), error),
    };
    let params: BmsParams = value.try_into().map_err(|e: toml::de::Error| last(e.to_string()))?;
    let mut description = Description::new(params).map_err(|e: ParamError| last(e.to_string()))?;
    for change in rows {
        let Some((id, field)) = row_of(&change.name) else { continue };
        let row = changed(*description.table().row(id), field, change)?;
        description = description.supposing(row).map_err(|error| change.refused(error))?;
    }
    Ok(description)
}

/// The row that a name begins with, and its field.
fn row_of(name: &str) -> Option<(Id, &str)> {
    let (row, field) = name.rsplit_once('.')?;
    let written = |id: &Id| format!("{id:?}").replace(' ', "").eq_ignore_ascii_case(row);
    Id::ALL.into_iter().find(written).map(|id| (id, field))
}

fn changed(mut row: Row, field: &str, change: &Change) -> Result<Row, ChangeError> {
    #[expect(clippy::cast_possible_truncation, reason = "a parameter's precision")]
    let real = |before: Real| change.of(f64::from(before)) as Real;
    match field {
        "threshold" => row.threshold = real(row.threshold),
        "hysteresis" => row.hysteresis = real(row.hysteresis),
        "count" => row.debounce.count = change.whole(row.debounce.count)?,
        "delay" => row.debounce.delay = change.whole(row.debounce.delay)?,
        "heal" => row.debounce.heal = change.whole(row.debounce.heal)?,
        _ => {
            let fields = "a row has threshold, hysteresis, count, delay, heal";
            return Err(ChangeError::Name(change.name.clone(), fields.to_owned()));
        }
    }
    Ok(row)
}

fn number_in<'v>(value: &'v mut Value, name: &str) -> Result<&'v mut Value, ChangeError> {
    let mut place = value;
    for part in name.split('.') {
        let known = place.as_table().map(|table| table.keys().cloned().collect::<Vec<_>>());
        let known = known.unwrap_or_default().join(", ");
        let nothing =
            || ChangeError::Name(name.to_owned(), format!("`{part}` is none of: {known}"));
        place = place.as_table_mut().and_then(|table| table.get_mut(part)).ok_or_else(nothing)?;
    }
    Ok(place)
}

fn set(place: &mut Value, change: &Change) -> Result<(), ChangeError> {
    match place {
        Value::Float(number) => *number = change.of(*number),
        Value::Integer(number) => {
            #[expect(clippy::cast_precision_loss, reason = "counts are small")]
            let value = change.of(*number as f64).round();
            #[expect(clippy::cast_possible_truncation, reason = "saturates, and is refused then")]
            let whole = value as i64;
            *number = whole;
        }
        other => {
            let what = format!("it is a {}", other.type_str());
            return Err(ChangeError::Name(change.name.clone(), what));
        }
    }
    Ok(())
}
