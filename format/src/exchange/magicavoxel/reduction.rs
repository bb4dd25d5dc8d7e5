//! Fewer colours: median cut (Heckbert 1982), but at the mean.

/// Colours of which there are too many, how often each is used, and which of `count` others it becomes. Returns these others,
/// and the place of each colour's among them.
///
/// The colours are divided into boxes. Again and again the box with the longest side, weighted by its uses, is cut across that
/// side at the mean of the uses: the median would part near colours of which one is used much. A box becomes its mean
/// colour.
pub(super) fn reduce(colors: &[([u8; 3], u64)], count: usize) -> (Vec<[u8; 3]>, Vec<usize>) {
    let mut boxes = vec![ColorBox::new((0..colors.len()).collect(), colors)];
    while boxes.len() < count {
        let worst = (0..boxes.len()).rev().max_by_key(|place| boxes[*place].error());
        let Some(worst) = worst.filter(|place| boxes[*place].error() > 0) else { break };
        let (low, high) = boxes[worst].cut(colors);
        boxes[worst] = low;
        boxes.push(high);
    }
    let mut places = vec![0; colors.len()];
    for (place, color_box) in boxes.iter().enumerate() {
        color_box.members.iter().for_each(|member| places[*member] = place);
    }
    (boxes.iter().map(|color_box| color_box.mean(colors)).collect(), places)
}

struct ColorBox {
    members: Vec<usize>,
    uses: u64,
    /// The channel with the longest side, and its length.
    channel: usize,
    side: u8,
}

impl ColorBox {
    fn new(members: Vec<usize>, colors: &[([u8; 3], u64)]) -> Self {
        let side = |channel: usize| {
            let values = members.iter().map(|member| colors[*member].0[channel]);
            let extremes =
                values.fold((u8::MAX, 0), |(low, high): (u8, u8), value| (low.min(value), high.max(value)));
            extremes.1.saturating_sub(extremes.0)
        };
        // Of equal sides that of green, which the eye sees best.
        let channel = [2, 0, 1].into_iter().max_by_key(|channel| side(*channel)).unwrap_or(1);
        let (uses, side) = (members.iter().map(|member| colors[*member].1.max(1)).sum(), side(channel));
        Self { members, uses, channel, side }
    }

    /// A box of equal colours has none.
    fn error(&self) -> u128 {
        u128::from(self.side).pow(2) * u128::from(self.uses)
    }

    /// Two boxes with at least one colour each, if the colours differ.
    fn cut(&self, colors: &[([u8; 3], u64)]) -> (Self, Self) {
        let mean = self.sum(self.channel, colors) / u128::from(self.uses);
        let is_low = |member: &usize| u128::from(colors[*member].0[self.channel]) <= mean;
        let (low, high) = self.members.iter().partition(|member| is_low(member));
        (Self::new(low, colors), Self::new(high, colors))
    }

    /// A channel's values, each as often as it is used.
    fn sum(&self, channel: usize, colors: &[([u8; 3], u64)]) -> u128 {
        let weighted = |member: &usize| {
            let (color, uses) = colors[*member];
            u128::from(color[channel]) * u128::from(uses.max(1))
        };
        self.members.iter().map(weighted).sum()
    }

    fn mean(&self, colors: &[([u8; 3], u64)]) -> [u8; 3] {
        let uses = u128::from(self.uses);
        std::array::from_fn(|channel| ((self.sum(channel, colors) + uses / 2) / uses) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colors_stay_as_they_are() {
        let colors = [([1, 2, 3], 5), ([200, 2, 3], 1), ([1, 250, 3], 9)];
        let (reduced, places) = reduce(&colors, 255);
        assert!(colors.iter().zip(&places).all(|((color, _), place)| reduced[*place] == *color));
    }

    #[test]
    fn near_colors_become_one() {
        let colors = [([10, 0, 0], 3), ([12, 0, 0], 1), ([240, 9, 9], 1), ([244, 9, 9], 1)];
        let (reduced, places) = reduce(&colors, 2);
        assert_eq!(places[0], places[1]);
        assert_eq!(places[2], places[3]);
        // The mean by use: (3 · 10 + 12) / 4, rounded.
        assert_eq!((reduced[places[0]], reduced[places[2]]), ([11, 0, 0], [242, 9, 9]));
    }

    #[test]
    fn a_ramp_is_divided_evenly() {
        let colors: Vec<_> = (0..=255).map(|value| ([value; 3], 1)).collect();
        let (reduced, places) = reduce(&colors, 16);
        assert_eq!(reduced.len(), 16);
        let error = |(color, place): (&([u8; 3], u64), &usize)| color.0[0].abs_diff(reduced[*place][0]);
        assert!(colors.iter().zip(&places).map(error).max().unwrap() <= 8);
    }
}
