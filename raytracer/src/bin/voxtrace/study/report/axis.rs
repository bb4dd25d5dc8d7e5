//! Axes of plots: where a value stands, and which values are marked.

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    Linear,
    /// Linear from 0 on.
    FromZero,
    /// Zeros have a place of their own below everything else.
    Logarithmic,
}

impl Scale {
    /// Logarithmic for values of different orders of magnitude.
    pub fn for_amounts(values: &[f64]) -> Self {
        let (least, most) = range(values.iter().copied().filter(|&value| value > 0.0));
        if least < most && most / least > 8.0 { Self::Logarithmic } else { Self::FromZero }
    }
}

/// An axis over a range of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub title: String,
    /// Values that are marked, and what is written there.
    pub ticks: Vec<(f64, String)>,
    is_logarithmic: bool,
    /// Least and greatest value, the logarithms of them on a logarithmic axis.
    range: [f64; 2],
    has_zero: bool,
}

/// Part of a logarithmic axis that is left to zeros.
const ZERO_PART: f64 = 0.11;
/// Where zeros stand there.
const ZERO: f64 = 0.035;
/// Free part at each end.
const MARGIN: f64 = 0.05;
/// No more marks than this.
const MOST_TICKS: i32 = 7;

impl Axis {
    /// An axis on which all the values have a place, as far as they are finite, and marks in round numbers.
    pub fn of(title: &str, values: &[f64], scale: Scale, format: fn(f64) -> String) -> Self {
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let mut axis = match scale {
            Scale::Logarithmic => Self::logarithmic(finite),
            Scale::Linear => Self::linear(finite),
            Scale::FromZero => Self::linear(finite.chain([0.0])),
        };
        axis.title = title.to_string();
        if axis.has_zero {
            axis.ticks.push((0.0, "0".to_string()));
        }
        axis.ticks.extend(axis.round_values().into_iter().map(|value| (value, format(value))));
        axis
    }

    fn linear(values: impl Iterator<Item = f64>) -> Self {
        let (least, most) = range(values);
        let (least, most) = if least <= most { (least, most) } else { (0.0, 1.0) };
        let margin = match most - least {
            0.0 if most == 0.0 => 1.0,
            0.0 => most.abs() / 2.0,
            length => length * MARGIN,
        };
        // No room below 0 for what cannot be less.
        let low = if least == 0.0 { 0.0 } else { least - margin };
        Self::over([low, most + margin], false, false)
    }

    /// On it, what is below 0 has no place.
    fn logarithmic(values: impl Iterator<Item = f64> + Clone) -> Self {
        let has_zero = values.clone().any(|value| value == 0.0);
        let (least, most) = range(values.filter(|&value| value > 0.0));
        if least > most {
            return Self::linear([0.0, 1.0].into_iter());
        }
        let (least, most) = (least.log10(), most.log10());
        let margin = ((most - least) * MARGIN).max(0.08);
        Self::over([least - margin, most + margin], true, has_zero)
    }

    fn over(range: [f64; 2], is_logarithmic: bool, has_zero: bool) -> Self {
        Self { title: String::new(), ticks: Vec::new(), is_logarithmic, range, has_zero }
    }

    /// Where a value stands, from 0 at the low end to 1; `None` if it has no place.
    pub fn position(&self, value: f64) -> Option<f64> {
        let [low, high] = self.range;
        let part = |value: f64| (value - low) / (high - low);
        let position = match self.is_logarithmic {
            true if value == 0.0 && self.has_zero => ZERO,
            true if value <= 0.0 => return None,
            true if self.has_zero => ZERO_PART + (1.0 - ZERO_PART) * part(value.log10()),
            true => part(value.log10()),
            false => part(value),
        };
        (-1e-9..=1.0 + 1e-9).contains(&position).then_some(position)
    }

    /// Where the place of zeros ends, if they have one of their own.
    pub fn zero_break(&self) -> Option<f64> {
        self.has_zero.then_some((ZERO + ZERO_PART) / 2.0)
    }

    /// Round values within the range, a few.
    fn round_values(&self) -> Vec<f64> {
        let [low, high] = self.range;
        if !self.is_logarithmic {
            return round_steps(low, high);
        }
        let decades = high - low;
        if decades < 0.7 {
            let mut values = round_steps(10_f64.powf(low), 10_f64.powf(high));
            values.retain(|&value| value > 0.0);
            return values;
        }
        let mantissas: &[f64] = match decades {
            _ if decades < 2.2 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let step = ((decades / f64::from(MOST_TICKS)).ceil() as usize).max(1);
        let exponents = (low.floor() as i32..=high.ceil() as i32).step_by(step);
        exponents
            .flat_map(|exponent| mantissas.iter().map(move |mantissa| (exponent, mantissa)))
            // Through text, because 10 to a negative power is not the number nearest to it.
            .filter_map(|(exponent, mantissa)| format!("{mantissa}e{exponent}").parse::<f64>().ok())
            .filter(|value| (low..=high).contains(&value.log10()))
            .collect()
    }
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn round_steps(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / f64::from(MOST_TICKS);
    let exponent = rough.log10().floor();
    let power = 10_f64.powf(exponent);
    let Some(factor) = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= rough * 0.999)
    else {
        return Vec::new();
    };
    let step = factor * power;
    let first = (low / step - 1e-9).ceil();
    let count = ((high / step + 1e-9).floor() - first).clamp(0.0, f64::from(2 * MOST_TICKS)) as i32;
    // Without the noise of the multiplication: 0.30000000000000004.
    let clean = |value: f64| format!("{value:.12e}").parse().unwrap_or(value);
    (0..=count).map(|index| clean((first + f64::from(index)) * step)).collect()
}

/// Least and greatest; the least is greater than the greatest if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)))
}

#[cfg(test)]
mod tests {
    use super::super::number::tick;
    use super::*;
    use proptest::prelude::*;

    fn ticks(values: &[f64], scale: Scale) -> Vec<f64> {
        Axis::of("", values, scale, tick).ticks.into_iter().map(|(value, _)| value).collect()
    }

    #[test]
    fn marks_are_round() {
        assert_eq!(ticks(&[0.3, 4.0], Scale::FromZero), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(ticks(&[0.001, 10.0], Scale::Logarithmic), [0.001, 0.01, 0.1, 1.0, 10.0]);
        assert_eq!(ticks(&[3.0, 30.0], Scale::Logarithmic), [5.0, 10.0, 20.0]);
        assert_eq!(ticks(&[0.0, 0.01, 10.0], Scale::Logarithmic)[..2], [0.0, 0.01]);
        assert_eq!(ticks(&[0.1, 0.35], Scale::Linear), [0.1, 0.15, 0.2, 0.25, 0.3, 0.35]);
    }

    #[test]
    fn zero_is_below_everything_on_a_logarithmic_axis() {
        let axis = Axis::of("", &[0.0, 1e-6, 1.0], Scale::Logarithmic, tick);
        assert!(axis.position(0.0).unwrap() < axis.zero_break().unwrap());
        assert!(axis.zero_break().unwrap() < axis.position(1e-6).unwrap());
        assert_eq!(axis.position(-1.0), None);
        assert_eq!(Axis::of("", &[1.0], Scale::Logarithmic, tick).position(0.0), None);
    }

    proptest! {
        #[test]
        fn every_value_has_its_place_and_their_order_is_kept(
            values in prop::collection::vec(prop_oneof![Just(0.0), 1e-9..1e9_f64, 0.0..1.0_f64], 0..9),
            scale in prop_oneof![Just(Scale::Linear), Just(Scale::FromZero), Just(Scale::Logarithmic)],
        ) {
            let axis = Axis::of("", &values, scale, tick);
            let mut sorted = values;
            sorted.sort_by(f64::total_cmp);
            let places: Vec<f64> = sorted.iter().map(|&value| axis.position(value).unwrap()).collect();
            prop_assert!(places.windows(2).all(|pair| pair[0] <= pair[1]));
            prop_assert!(places.iter().all(|place| (0.0..=1.0).contains(place)));
            prop_assert!(axis.ticks.len() <= 17);
            for (value, _) in &axis.ticks {
                prop_assert!(axis.position(*value).is_some(), "{value} in {:?}", axis.range);
            }
        }
    }
}
