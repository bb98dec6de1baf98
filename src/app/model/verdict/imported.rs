//! An imported geometry in words.

use super::Fact;
use crate::app::model::document::Imported;
use crate::geometry::looks_essential;

pub fn import_warning(imported: &Imported) -> Option<&'static str> {
    match &imported.check {
        None => Some(
            "Unchecked: there were too few matches when it was imported. Compare judges it once there are matches.",
        ),
        Some(check) if check.fits => None,
        Some(_) if looks_essential(imported.fundamental.matrix()) => {
            Some("It looks like an essential matrix E, which does not fit pixels. Compare says more.")
        }
        Some(_) => Some("It does not fit the matches of these images. It may belong to other images."),
    }
}

/// Returns the origin and the check of an imported geometry.
pub fn import_facts(imported: &Imported) -> Vec<Fact> {
    let check = imported.check.as_ref();
    let median =
        check.map_or_else(|| "unchecked".to_owned(), |check| format!("median {:.2} px", check.median));
    let of = check.map(|check| {
        let tooltip = "Point pairs that the geometry was checked with at the time of the import.";
        Fact::new("Checked on", format!("{} {}", check.matches, check.of), tooltip)
    });
    let facts = [
        Fact::new("From", imported.file.clone(), "File that the geometry was imported from."),
        Fact::new(
            "Convention",
            if imported.is_as_read() { "as in the file".to_owned() } else { imported.reading.clone() },
            "Convention in which the numbers of the file were read. As in the file: they were taken without a change.",
        ),
        Fact::new("Checked", median, "Median symmetric distance of these pairs at the time of the import."),
    ];
    facts.into_iter().chain(of).collect()
}
