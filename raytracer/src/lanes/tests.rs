//! Every width against plain Rust, lane by lane.

use super::{Choice, Doubles, Eight, Four, Lanes, MAX_LANES, Pair, Single, Sixteen};
use crate::octree::cell_of_morton;
use crate::random::Random;

/// Runs a generic check for every width.
macro_rules! for_every_width {
    ($($check:ident),* $(,)?) => {$(
        #[test]
        fn $check() {
            super::tests::check::$check::<Single>();
            super::tests::check::$check::<Four>();
            super::tests::check::$check::<Eight>();
            super::tests::check::$check::<Sixteen>();
            super::tests::check::$check::<Pair<Sixteen>>();
            super::tests::check::$check::<Doubles>();
        }
    )*};
}

for_every_width!(
    words_go_in_and_out,
    floats_go_in_and_out,
    integer_operations_agree,
    float_operations_agree,
    comparisons_agree,
    cells_ahead_are_at_most_as_far_up,
    rows_are_gathered_where_asked,
    any_row_may_be_asked_for,
    words_are_chosen_by_number,
    lanes_change_places,
    each_lane_is_visited_on_its_level,
);

/// What double precision is for, lane by lane.
#[test]
fn double_precision_is_kept() {
    let random = &mut Random::stream(6, 0);
    for _ in 0..2000 {
        let mut number = || {
            let mantissa = (random.next() >> 12) as f64 / (1u64 << 52) as f64;
            (1.0 + mantissa) * 2f64.powi(random.between(-20, 20))
        };
        let (a, b): ([f64; MAX_LANES], [f64; MAX_LANES]) =
            (std::array::from_fn(|_| number()), std::array::from_fn(|_| number()));
        let (va, vb) = (Doubles::load_reals(&a), Doubles::load_reals(&b));
        let agree = |name: &str, value, plain: &dyn Fn(f64, f64) -> f64| {
            let expected: Vec<f64> = a.iter().zip(&b).take(8).map(|(&a, &b)| plain(a, b)).collect();
            assert_eq!(Doubles::reals(value)[..8], expected, "{name} of {a:?} and {b:?}");
        };
        agree("itself", va, &|a, _| a);
        agree("next up", Doubles::next_up(va), &|a, _| a.next_up());
        agree("quotient", Doubles::quotient(va, Doubles::divisor(vb)), &|a, b| a / -b);
        agree("less", Doubles::select(Doubles::less(va, vb), va, vb), &f64::min);
        agree("more", Doubles::select(Doubles::at_most(va, vb), vb, va), &f64::max);

        // Coordinates: to single precision, towards zero.
        let near = a.map(|a| 1.0 + a.fract());
        let bits = Doubles::to_bits(Doubles::load_reals(&near));
        agree("coordinate", Doubles::from_bits(bits), &|a, _| {
            let near = 1.0 + a.fract();
            let rounded = near as f32;
            f64::from(if f64::from(rounded) > near { rounded.next_down() } else { rounded })
        });
    }
    assert_eq!(Doubles::reals(Doubles::real(0.1))[..8], [0.1; 8]);
}

mod check {
    use super::*;

    fn words<L: Lanes>(value: L::Word) -> Vec<u32> {
        let mut out = [0; MAX_LANES];
        L::store_words(value, &mut out);
        out[..L::COUNT].to_vec()
    }

    fn floats<L: Lanes>(value: L::Float) -> Vec<f32> {
        let mut out = [0.0; MAX_LANES];
        L::store(value, &mut out);
        out[..L::COUNT].to_vec()
    }

    fn random_words(random: &mut Random) -> [u32; MAX_LANES] {
        std::array::from_fn(|_| {
            let word = random.next() as u32;
            // Small words and single bits too.
            match random.next() % 4 {
                0 => word,
                1 => word >> 27,
                2 => 1 << (word % 32),
                _ => 0,
            }
        })
    }

    /// Finite floats of all sizes, zeros of either sign.
    fn random_floats(random: &mut Random) -> [f32; MAX_LANES] {
        std::array::from_fn(|_| match random.next() % 5 {
            0 => 0.0,
            1 => -0.0,
            2 => random.between(-5, 6) as f32,
            _ => f32::from_bits(random.next() as u32 & !(1 << 30)),
        })
    }

    fn mask_of<L: Lanes>(bits: u32) -> L::Mask {
        let flags: [u32; MAX_LANES] = std::array::from_fn(|lane| bits >> lane & 1);
        L::same_word(L::load_words(&flags), L::word(1))
    }

    fn bits_of(flags: impl Iterator<Item = bool>) -> u32 {
        flags.enumerate().fold(0, |bits, (lane, flag)| bits | u32::from(flag) << lane)
    }

    pub fn words_go_in_and_out<L: Lanes>() {
        let values: [u32; MAX_LANES] = std::array::from_fn(|lane| lane as u32 * 0x0101_0101);
        assert_eq!(words::<L>(L::load_words(&values)), values[..L::COUNT]);
        assert_eq!(words::<L>(L::word(7)), vec![7; L::COUNT]);
        for count in 0..=L::COUNT {
            assert_eq!(L::bitmask(L::first(count)), ((1u64 << count) - 1) as u32);
        }
    }

    pub fn floats_go_in_and_out<L: Lanes>() {
        let values: [f32; MAX_LANES] = std::array::from_fn(|lane| lane as f32 - 2.5);
        assert_eq!(floats::<L>(L::load(&values)), values[..L::COUNT]);
        let bits = L::to_bits(L::load(&values));
        assert_eq!(floats::<L>(L::from_bits(bits)), values[..L::COUNT]);
        assert_eq!(floats::<L>(L::abs(L::float(-3.0))), vec![3.0; L::COUNT]);
    }

    pub fn integer_operations_agree<L: Lanes>() {
        let random = &mut Random::stream(1, 0);
        for _ in 0..2000 {
            let (a, b) = (random_words(random), random_words(random));
            let (va, vb) = (L::load_words(&a), L::load_words(&b));
            let count = L::load_words(&b.map(|word| word % 32));
            let below = a.map(|word| (word % (1 << 24)) | 1);
            let agree = |name: &str, value: L::Word, plain: &dyn Fn(u32, u32) -> u32| {
                let expected: Vec<u32> =
                    a.iter().zip(&b).take(L::COUNT).map(|(&a, &b)| plain(a, b)).collect();
                assert_eq!(words::<L>(value), expected, "{name} of {a:?} and {b:?}");
            };
            agree("and", va & vb, &|a, b| a & b);
            agree("or", va | vb, &|a, b| a | b);
            agree("xor", va ^ vb, &|a, b| a ^ b);
            agree("add", L::add(va, vb), &u32::wrapping_add);
            agree("sub", L::sub(va, vb), &u32::wrapping_sub);
            agree("shift left", L::shift_left(va, count), &|a, b| a << (b % 32));
            agree("shift right", L::shift_right(va, count), &|a, b| a >> (b % 32));
            agree("bit", L::bit(va), &|a, _| 1 << (a % 32));
            agree("count ones", L::count_ones(va), &|a, _| a.count_ones());
            agree("spread x", L::spread::<0>(va), &|a, _| a & 1 | (a >> 1 & 1) << 3);
            agree("spread y", L::spread::<1>(va), &|a, _| (a & 1) << 1 | (a >> 1 & 1) << 4);
            agree("spread z", L::spread::<2>(va), &|a, _| (a & 1) << 2 | (a >> 1 & 1) << 5);
            agree("highest bit", L::highest_bit(L::load_words(&below)), &|a, _| {
                ((a % (1 << 24)) | 1).ilog2()
            });
            let of_all = L::highest_bit_of_all(va);
            let of_any = L::select_word(L::test(va, L::word(u32::MAX)), of_all, L::word(99));
            agree("highest bit of all", of_any, &|a, _| a.checked_ilog2().unwrap_or(99));
            assert!(words::<L>(of_all).iter().all(|&place| place < 32));
        }
    }

    pub fn float_operations_agree<L: Lanes>() {
        let random = &mut Random::stream(2, 0);
        for _ in 0..2000 {
            let (a, b) = (random_floats(random), random_floats(random));
            let (va, vb) = (L::load(&a), L::load(&b));
            let bits = random.next() as u32;
            let agree = |name: &str, value: L::Float, plain: &dyn Fn(f32, f32) -> f32| {
                let found: Vec<u32> = floats::<L>(value).iter().map(|float| float.to_bits()).collect();
                let expected: Vec<u32> =
                    a.iter().zip(&b).take(L::COUNT).map(|(&a, &b)| plain(a, b).to_bits()).collect();
                assert_eq!(found, expected, "{name} of {a:?} and {b:?}");
            };
            agree("add", va + vb, &|a, b| a + b);
            agree("sub", va - vb, &|a, b| a - b);
            agree("mul", va * vb, &|a, b| a * b);
            agree("min", L::min(va, vb), &|a, b| if a < b { a } else { b });
            agree("max", L::max(va, vb), &|a, b| if a > b { a } else { b });
            if b[..L::COUNT].iter().all(|&b| b != 0.0) {
                agree("div", va / vb, &|a, b| a / b);
            }
            let selected = floats::<L>(L::select(mask_of::<L>(bits), va, vb));
            for lane in 0..L::COUNT {
                let expected = if bits >> lane & 1 == 1 { a[lane] } else { b[lane] };
                assert_eq!(selected[lane].to_bits(), expected.to_bits());
            }
        }
    }

    pub fn comparisons_agree<L: Lanes>() {
        let random = &mut Random::stream(3, 0);
        for _ in 0..2000 {
            let (a, b) = (random_floats(random), random_floats(random));
            let pairs = || a.into_iter().zip(b).take(L::COUNT);
            let (va, vb) = (L::load(&a), L::load(&b));
            assert_eq!(L::bitmask(L::less(va, vb)), bits_of(pairs().map(|(a, b)| a < b)));
            assert_eq!(L::bitmask(L::at_most(va, vb)), bits_of(pairs().map(|(a, b)| a <= b)));
            assert_eq!(L::bitmask(L::same(va, vb)), bits_of(pairs().map(|(a, b)| a == b)));

            let (a, b) = (random_words(random), random_words(random));
            let pairs = || a.into_iter().zip(b).take(L::COUNT);
            let (va, vb) = (L::load_words(&a), L::load_words(&b));
            assert_eq!(L::bitmask(L::same_word(va, vb)), bits_of(pairs().map(|(a, b)| a == b)));
            assert_eq!(L::bitmask(L::test(va, vb)), bits_of(pairs().map(|(a, b)| a & b != 0)));
            let half = |words: [u32; MAX_LANES]| L::load_words(&words.map(|word| word >> 1));
            let greater = bits_of(pairs().map(|(a, b)| a >> 1 > b >> 1));
            assert_eq!(L::bitmask(L::greater(half(a), half(b))), greater);

            let (first, second) = (random.next() as u32, random.next() as u32);
            let all = ((1u64 << L::COUNT) - 1) as u32;
            let (mask, other) = (mask_of::<L>(first), mask_of::<L>(second));
            assert_eq!(L::bitmask(mask & other), first & second & all);
            assert_eq!(L::bitmask(mask | other), (first | second) & all);
            assert_eq!(L::bitmask(!mask) & all, !first & all);
            assert_eq!(L::any(mask), first & all != 0);
        }
    }

    pub fn cells_ahead_are_at_most_as_far_up<L: Lanes>() {
        let random = &mut Random::stream(5, 0);
        for _ in 0..500 {
            let place: [[u32; MAX_LANES]; 3] = std::array::from_fn(|_| random_words(random));
            let mirror: [[u32; MAX_LANES]; 3] = std::array::from_fn(|_| {
                std::array::from_fn(|_| if random.next() & 1 == 1 { u32::MAX } else { 0 })
            });
            let load = |words: &[[u32; MAX_LANES]; 3]| [0, 1, 2].map(|axis| L::load_words(&words[axis]));
            let halves = L::cells_ahead(load(&place), load(&mirror)).map(words::<L>);
            for lane in 0..L::COUNT {
                let is_ahead = |cell: u32| {
                    let position = cell_of_morton(cell);
                    (0..3).all(|axis| {
                        let mirrored = mirror[axis][lane] == u32::MAX;
                        let along = if mirrored { 3 - position[axis] } else { position[axis] };
                        along <= place[axis][lane] % 4
                    })
                };
                let expected =
                    (0..64).filter(|&cell| is_ahead(cell)).fold(0, |cells, cell| cells | 1 << cell);
                let found = u64::from(halves[0][lane]) | u64::from(halves[1][lane]) << 32;
                assert_eq!(found, expected);
            }
        }
    }

    pub fn rows_are_gathered_where_asked<L: Lanes>() {
        let rows: Vec<[u32; 4]> = (0..100).map(|row| [0, 1, 2, 3].map(|column| row * 5 + column)).collect();
        let random = &mut Random::stream(7, 0);
        for _ in 0..500 {
            let bits = random.next() as u32;
            // Where the mask is false, the index is far beyond the rows.
            let index: [u32; MAX_LANES] = std::array::from_fn(|lane| {
                if bits >> lane & 1 == 1 { random.between(0, 100) as u32 } else { u32::MAX }
            });
            let otherwise: [[u32; MAX_LANES]; 4] =
                [1000, 2000, 3000, 4000].map(|first| std::array::from_fn(|lane| first + lane as u32));
            let kept = otherwise.each_ref().map(|words| L::load_words(words));
            // SAFETY: the index is that of a row wherever the mask is true, and there are rows.
            let found = unsafe { L::gather_rows(&rows, L::load_words(&index), mask_of::<L>(bits), kept) };
            for (column, &found) in found.iter().enumerate() {
                for (lane, &word) in words::<L>(found).iter().enumerate() {
                    let asked = bits >> lane & 1 == 1;
                    let expected =
                        if asked { rows[index[lane] as usize][column] } else { otherwise[column][lane] };
                    assert_eq!(word, expected, "column {column} of lane {lane}");
                }
            }
        }
    }

    pub fn any_row_may_be_asked_for<L: Lanes>() {
        let random = &mut Random::stream(9, 0);
        for rows in [&[][..], &[[1, 2, 3, 4]]] {
            L::prefetch_rows(rows, L::load_words(&random_words(random)));
            L::prefetch_rows(rows, L::word(u32::MAX));
        }
    }

    pub fn lanes_change_places<L: Lanes>() {
        let random = &mut Random::stream(14, 0);
        for _ in 0..500 {
            let (values, numbers, from) =
                (random_words(random), random_floats(random), random_words(random).map(|lane| lane % 32));
            let taken = from.map(|lane| lane as usize % L::COUNT);
            let places = L::load_words(&from);
            let found = words::<L>(L::permuted_word(L::load_words(&values), places));
            let expected: Vec<u32> = taken[..L::COUNT].iter().map(|&lane| values[lane]).collect();
            assert_eq!(found, expected, "{values:?} from {from:?}");
            let found = floats::<L>(L::permuted(L::load(&numbers), places)).into_iter().map(f32::to_bits);
            let expected = taken[..L::COUNT].iter().map(|&lane| numbers[lane].to_bits());
            assert!(found.eq(expected), "{numbers:?} from {from:?}");
        }
    }

    pub fn words_are_chosen_by_number<L: Lanes>() {
        let random = &mut Random::stream(10, 0);
        for _ in 0..500 {
            let table = [(); 4].map(|()| random.next() as u32);
            let number: [u32; MAX_LANES] = std::array::from_fn(|_| random.between(0, 4) as u32);
            let is_at_least =
                |least: u32| mask_of::<L>(bits_of(number.iter().map(|&number| number >= least)));
            let chosen = L::choose(&Choice::new(table), [1, 2, 3].map(is_at_least));
            let expected: Vec<u32> =
                number[..L::COUNT].iter().map(|&number| table[number as usize]).collect();
            assert_eq!(words::<L>(chosen), expected);
        }
    }

    pub fn each_lane_is_visited_on_its_level<L: Lanes>() {
        let random = &mut Random::stream(5, 0);
        for _ in 0..500 {
            let level: [u32; MAX_LANES] = std::array::from_fn(|_| random.between(0, 12) as u32);
            let bits = random.next() as u32;
            let mut visited = vec![None; L::COUNT];
            L::for_each_level(2..9, L::load_words(&level), mask_of::<L>(bits), |number, mask| {
                for (lane, visited) in visited.iter_mut().enumerate() {
                    if L::bitmask(mask) >> lane & 1 == 1 {
                        assert_eq!(visited.replace(number), None, "lane {lane} is visited twice");
                    }
                }
            });
            for (lane, visited) in visited.into_iter().enumerate() {
                let expected = bits >> lane & 1 == 1 && (2..9).contains(&level[lane]);
                assert_eq!(visited, expected.then_some(level[lane] as usize));
            }
        }
    }
}
