//! Parts of the work on the command line: a region of a picture, some of several frames.

use anyhow::ensure;
use octvox_raytracer::Region;
use std::ops::Range;

/// # Errors
/// If a region is not within a picture of this size.
pub fn check_within(region: &Region, [columns, rows]: [u32; 2]) -> anyhow::Result<()> {
    let Region { corner: [x, y], size: [width, height] } = *region;
    let fits = |first: u32, count: u32, all: u32| u64::from(first) + u64::from(count) <= u64::from(all);
    ensure!(
        fits(x, width, columns) && fits(y, height, rows),
        "the region {x},{y},{width},{height} reaches beyond the picture, which is {columns}x{rows}"
    );
    Ok(())
}

/// A region from `X,Y,W,H`: the upper left corner, columns and rows.
pub fn parse_region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => {
            Ok(Region { corner: [x, y], size: [width, height] })
        }
        _ => Err(
            "expected left column, top row, columns and rows, the last two above zero, such as 0,0,640,320"
                .into(),
        ),
    }
}

/// Numbers of frames from `FIRST..END`, `FIRST..=LAST` or a single number.
pub fn parse_frames(text: &str) -> Result<Range<u32>, String> {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    // The number after the last one must be one, too.
    let after = |text: &str| number(text)?.checked_add(1);
    let frames = match text.split_once("..") {
        Some((first, rest)) => {
            let end = rest.strip_prefix('=').map_or_else(|| number(rest), after);
            number(first).zip(end)
        }
        None => number(text).zip(after(text)),
    };
    match frames {
        Some((first, end)) if first < end => Ok(first..end),
        Some(_) => Err("there is no frame in it; the first number must be below the end".into()),
        None => Err("expected a frame or some, such as 10, 10..20 (without 20) or 10..=20".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions() {
        let region = Region { corner: [0, 10], size: [640, 320] };
        assert_eq!(parse_region("0,10,640,320"), Ok(region));
        assert_eq!(parse_region("0, 10, 640, 320"), Ok(region));
        for text in
            ["", "1,2,3", "1,2,3,4,5", "0,0,0,1", "0,0,1,0", "-1,0,1,1", "0,0,1.5,1", "0,0,4294967296,1"]
        {
            assert!(parse_region(text).unwrap_err().contains("such as"), "{text}");
        }
    }

    #[test]
    fn a_region_lies_in_the_picture() {
        let region = parse_region("2,3,4,5").unwrap();
        assert!(check_within(&region, [6, 8]).is_ok());
        let error = check_within(&region, [6, 7]).unwrap_err().to_string();
        assert_eq!(error, "the region 2,3,4,5 reaches beyond the picture, which is 6x7");
        let far = Region { corner: [u32::MAX, 3], size: [u32::MAX, 5] };
        assert!(check_within(&far, [u32::MAX, 8]).is_err());
    }

    #[test]
    fn frames() {
        assert_eq!(parse_frames("10..20"), Ok(10..20));
        assert_eq!(parse_frames("10..=20"), Ok(10..21));
        assert_eq!(parse_frames("10"), Ok(10..11));
        assert_eq!(parse_frames("0 .. 1"), Ok(0..1));
        for text in ["20..10", "10..10", "11..=10"] {
            assert!(parse_frames(text).unwrap_err().contains("no frame"), "{text}");
        }
        for text in ["", "..", "10..", "..20", "a", "1..2..3", "-1", "4294967295", "0..=4294967295"] {
            assert!(parse_frames(text).unwrap_err().contains("expected"), "{text}");
        }
    }
}
