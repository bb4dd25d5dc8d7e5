use super::sample::{AWKWARD, draw_pictures, study};
use super::write;
use crate::study::front::front;
use crate::study::record::{Errors, Setting, Study};
use std::collections::HashMap;
use std::fs::read_to_string;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A folder with the report of a study, its page and its table.
struct Report {
    folder: TempDir,
    page: String,
}

fn report(study: &Study) -> Report {
    let folder = tempdir().unwrap();
    write(folder.path(), study).unwrap();
    let page = read_to_string(folder.path().join("report.html")).unwrap();
    check_page(&page);
    Report { folder, page }
}

/// The page is XML as well as HTML, so a parser of that says whether it is well formed.
fn check_page(page: &str) {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = roxmltree::Document::parse_with_options(page, options).unwrap();
    let mut ids = Vec::new();
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        for attribute in node.attributes() {
            let value = attribute.value();
            match attribute.name() {
                "id" => ids.push(value.to_string()),
                "src" => assert!(value.starts_with("data:image/png;base64,")),
                "href" => assert!(value.starts_with('#')),
                _ => assert!(!value.contains("NaN"), "{value}"),
            }
        }
        let name = node.tag_name().name();
        assert!(!["link", "iframe", "object", "image"].contains(&name), "{name}");
        if name == "table" {
            let widths: Vec<usize> = node
                .descendants()
                .filter(|node| node.has_tag_name("tr"))
                .map(|row| {
                    let cells = row.children().filter(roxmltree::Node::is_element);
                    cells.map(|cell| cell.attribute("colspan").map_or(1, |span| span.parse().unwrap())).sum()
                })
                .collect();
            assert!(widths.windows(2).all(|pair| pair[0] == pair[1]), "{widths:?}");
        }
    }
    for node in document.descendants() {
        if let Some(target) = node.attribute("href") {
            assert!(ids.contains(&target[1..].to_string()), "{target}");
        }
    }
    let count = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id twice");
    assert!(!page.contains("http") && !page.contains("url(") && !page.contains("@import"));
}

/// The text that a reader sees.
fn text(page: &str) -> String {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = roxmltree::Document::parse_with_options(page, options).unwrap();
    document.descendants().filter_map(|node| node.text()).collect::<Vec<_>>().join(" ")
}

fn check_plot(path: &Path) {
    let picture = image::open(path).unwrap().to_rgb8();
    assert_eq!(picture.width(), 1200);
    assert!((400..1000).contains(&picture.height()));
    let count = |of: &dyn Fn([u8; 3]) -> bool| picture.pixels().filter(|pixel| of(pixel.0)).count();
    let all = (picture.width() * picture.height()) as usize;
    assert!(count(&|pixel| pixel == [255; 3]) > all / 2, "{}", path.display());
    assert!(count(&|[red, green, blue]| red < 120 && green < 120 && blue < 120) > 500, "{}", path.display());
    assert!(count(&|[red, _, blue]| red.abs_diff(blue) > 80) > 200, "{}", path.display());
}

#[test]
fn the_page_shows_everything() {
    let mut study = study();
    let folder = tempdir().unwrap();
    draw_pictures(folder.path(), &mut study);
    write(folder.path(), &study).unwrap();
    let page = read_to_string(folder.path().join("report.html")).unwrap();
    check_page(&page);
    let text = text(&page);
    for setting in &study.settings {
        assert!(text.contains(&setting.label), "{}", setting.label);
        assert!(text.contains(&setting.command), "{}", setting.command);
    }
    for knob in &study.knobs {
        assert!(text.contains(&knob.title));
    }
    assert!(text.contains("Shell & <friends>") && text.contains(AWKWARD) && text.contains("along x < 0"));
    let front = front(&study);
    assert!(front.settings.len() > 5);
    assert!(text.contains(&format!("{} of {} settings are on the front", front.settings.len(), 34)));
    // The truth, and of each knob at most eight settings with two pictures each.
    assert_eq!(page.matches("<img ").count(), 1 + 2 * (8 + 7 + 8 + 6 + 4 + 6));
    assert_eq!(page.matches("class=\"missing\"").count(), 0);
    for name in ["front", "lod", "resolution", "samples", "shadows", "smoothing", "bounces"] {
        check_plot(&folder.path().join("plots").join(name).with_extension("png"));
    }
    // Nothing temporary is left.
    let count = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(count, 3 + 1 + 2 * study.settings.len());
}

#[test]
fn the_table_holds_the_same_numbers() {
    let mut study = study();
    study.settings[3].against_truth = None;
    study.settings[4].cost.instructions = None;
    study.settings[5].command = "voxtrace \"a, b\"\nüber".to_string();
    let report = report(&study);
    let mut reader = csv::Reader::from_path(report.folder.path().join("results.csv")).unwrap();
    let rows: Vec<HashMap<String, String>> = reader.deserialize().map(Result::unwrap).collect();
    assert_eq!(rows.len(), study.settings.len());
    let front = front(&study);
    for (index, (row, setting)) in rows.iter().zip(&study.settings).enumerate() {
        let number = |name: &str| row[name].parse::<f64>().ok();
        let cost = &setting.cost;
        assert_eq!(
            [&row["knob"], &row["setting"], &row["command"]],
            [&setting.knob, &setting.label, &setting.command]
        );
        assert_eq!(number("place"), Some(setting.place));
        assert_eq!(number("seconds_median"), Some(cost.seconds.median));
        assert_eq!(number("seconds_least"), Some(cost.seconds.least));
        assert_eq!(number("seconds_most"), Some(cost.seconds.most));
        assert_eq!(row["repetitions"].parse(), Ok(cost.seconds.repetitions));
        assert_eq!(row["instructions"].parse().ok(), cost.instructions);
        assert_eq!(row["rays"].parse(), Ok(cost.rays));
        assert_eq!(row["steps"].parse(), Ok(cost.steps));
        assert_eq!(row["octree_bytes"].parse(), Ok(cost.bytes));
        assert_eq!(number("preparation_seconds"), Some(cost.preparation));
        assert_eq!(row["is_default"].parse(), Ok(setting.is_default));
        assert_eq!(row["is_exact"].parse(), Ok(setting.is_exact));
        assert_eq!(row["is_on_front"].parse(), Ok(front.contains(index)));
        assert_eq!(number("distance_from_front"), front.distance(index));
        for (name, errors) in [("exact", &setting.against_exact), ("truth", &setting.against_truth)] {
            let number = |measure: &str| number(&format!("{name}_{measure}"));
            let read = number("flip").map(|flip| Errors {
                depth_voxels: number("depth_voxels").unwrap(),
                depth_pixels: number("depth_pixels").unwrap(),
                normal_degrees: number("normal_degrees").unwrap(),
                color: number("color").unwrap(),
                ssim: number("ssim").unwrap(),
                flip,
                silhouette: number("silhouette").unwrap(),
                other_voxels: number("other_voxels"),
            });
            assert_eq!(read, *errors);
        }
    }
}

/// Whatever a study lacks, the report is made and well formed.
#[test]
fn a_study_may_lack_anything() {
    let mut whole = study();
    // Two knobs are enough here, and plots take their time.
    whole.knobs.truncate(2);
    whole.settings.retain(|setting| ["lod", "resolution"].contains(&setting.knob.as_str()));
    let whole = whole;
    let changed = |change: &dyn Fn(&mut Study)| {
        let mut study = whole.clone();
        change(&mut study);
        report(&study).page
    };
    let each = |study: &mut Study, change: &dyn Fn(&mut Setting)| study.settings.iter_mut().for_each(change);

    let page = changed(&|study| each(study, &|setting| setting.against_truth = None));
    assert!(page.contains("FLIP against the exact setting") && !page.contains("FLIP against the truth"));
    let page = changed(&|study| {
        each(study, &|setting| (setting.against_truth, setting.against_exact) = (None, None));
    });
    assert!(page.contains("nothing to compare") && !page.contains("How far it is off"));
    let page = changed(&|study| each(study, &|setting| setting.against_exact = None));
    assert!(!page.contains("<th scope=\"colgroup\" colspan=\"8\" class=\"group\">against the exact"));
    changed(&|study| each(study, &|setting| (setting.picture, setting.difference) = (None, None)));
    changed(&|study| study.settings.truncate(1));
    changed(&|study| study.settings.clear());
    changed(&|study| study.knobs.clear());
    changed(&|study| study.chapters.clear());
    changed(&|study| study.chapters[0].tables[0].rows[1].truncate(1));
    changed(&|study| (study.truth, study.machine.processor) = (String::new(), String::new()));
    changed(&|study| {
        each(study, &|setting| {
            setting.against_truth.as_mut().unwrap().flip = 0.0;
            setting.place = 0.0;
            setting.cost.seconds.median = 0.0;
            setting.cost.seconds.least = 0.0;
        });
    });
    changed(&|study| {
        each(study, &|setting| {
            setting.against_truth.as_mut().unwrap().flip = f64::NAN;
            setting.against_truth.as_mut().unwrap().depth_voxels = f64::INFINITY;
            setting.place = f64::INFINITY;
            setting.cost.seconds.most = f64::NAN;
        });
    });
    changed(&|study| study.knobs[0].name = "../../lod <x>".to_string());
}

#[test]
fn a_report_is_replaced_and_a_folder_that_cannot_be_is_named() {
    let mut study = study();
    let first = report(&study);
    study.title = "Another".to_string();
    write(first.folder.path(), &study).unwrap();
    let page = read_to_string(first.folder.path().join("report.html")).unwrap();
    assert!(page.contains("<h1>Another</h1>") && !first.page.contains("<h1>Another</h1>"));

    let file = first.folder.path().join("results.csv");
    let error = write(&file, &study).unwrap_err();
    assert!(format!("{error:#}").contains("results.csv"), "{error:#}");
}

/// To look at it: writes a report into the folder that `OCTVOX_REPORT` names.
#[test]
#[ignore = "writes files to be looked at"]
fn made_up_report() {
    let folder = std::env::var_os("OCTVOX_REPORT").expect("OCTVOX_REPORT names no folder");
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder).unwrap();
    let mut study = study();
    draw_pictures(folder, &mut study);
    write(folder, &study).unwrap();
}
