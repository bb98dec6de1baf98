//! Sentences for the reasons of a verdict and for the warnings about a result.
//!
//! Each message states the fact, then the consequence, then the action, in at most three short
//! sentences. Pairs of points have the names of [`PairNames`]. `docs/verdicts.md` explains every
//! message.

use crate::estimate::{
    ENOUGH_MATCHES, Lack, Missing, PairNames, PairNumbers, Reason, Suspect, Trust, Warning,
};

/// Returns the message of a reason, with pairs by their numbers.
pub fn reason_in_words(reason: &Reason) -> String {
    named_reason_in_words(reason, &PairNumbers)
}

/// Returns the message of a reason, with names of pairs.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn named_reason_in_words(reason: &Reason, names: &dyn PairNames) -> String {
    match *reason {
        Reason::NotChecked => "Only lines were compared, so nothing else confirms this geometry. \
             Use the preset robust, which also compares small image patches."
            .into(),
        Reason::NotRefined => {
            "Too few image patches match along the epipolar lines. The geometry may be wrong. \
             Check your point pairs, or add one."
                .into()
        }
        Reason::RefinementOff => {
            "Refinement is off, so no matches at full resolution confirm this geometry. \
             Turn refinement on."
                .into()
        }
        Reason::ClicksAlone => {
            "This geometry rests on the point pairs alone. The matches found in the images do not agree with it. \
             Check that each pair shows the same scene point, and that left and right are not exchanged."
                .into()
        }
        Reason::PointsAlone { agreeing, matches } => format!(
            "{agreeing} of {matches} given matches agree on this geometry, more than by chance. \
             Without pictures, nothing confirms that they show the same scene points. \
             Give the pictures, too, to check them."
        ),
        Reason::PointsByChance { agreeing, matches } => format!(
            "Only {agreeing} of {matches} given matches agree on this geometry, which chance explains: any seven fit one. \
             Give more matches, or the pictures."
        ),
        Reason::GivenAlone { matches } => format!(
            "{matches} given matches agree with each other, but the matches found in the images do not confirm them. \
             This geometry rests on the given matches alone. \
             Check that they belong to these images and to their size."
        ),
        Reason::GivenContradict { contradicting, matches, distance } => format!(
            "{contradicting} of {matches} given matches are off their epipolar lines, by {distance:.1} px (median). \
             The given matches or this geometry must be wrong. \
             Check that the matches belong to these images and to their size."
        ),
        Reason::ByChance { agreeing, matches } => format!(
            "Only {agreeing} of {matches} distinctive matches are on their epipolar lines, as chance may explain. \
             The geometry may be wrong. Add point pairs, or use images that overlap more."
        ),
        Reason::DifferentScenes { agreeing, by_chance, matches } => format!(
            "Only {agreeing} of {matches} distinctive matches agree on one geometry, and chance explains up to {by_chance}. \
             The pictures may show different scenes. Choose other pictures, or add point pairs."
        ),
        Reason::FewMatches { matches } => format!(
            "Only {matches} image patches match along the epipolar lines. \
             Fewer than {ENOUGH_MATCHES} can match by chance. \
             Add a point pair, or use images that overlap more."
        ),
        Reason::BarcodesByChance { correlation, by_chance } => format!(
            "Corresponding lines share no more motion than by chance (correlation {correlation:.2}, \
             by chance {by_chance:.2}). \
             The recordings may not be simultaneous, the motion may repeat itself, or too little moves. \
             Check the frame offset, or record more motion."
        ),
        Reason::FewBarcodes { lines } => format!(
            "The recorded motion distinguishes only {lines} epipolar lines, too few for a reliable geometry. \
             Record more frames, or motion in more places."
        ),
        Reason::LooseBarcodes { deviation } => format!(
            "Even if the geometry is right, the recorded motion leaves its epipolar lines uncertain by {deviation:.1} px. \
             Record more frames, or motion in more places."
        ),
        Reason::ClickOff { pair, distance, suspect } => {
            let (pair, distance) = (names.name(pair), names.off_line(pair, distance));
            let advice = match suspect {
                Suspect::Click => {
                    "The images support the geometry, so the pair is probably misplaced. \
                     Check that both points show the same scene point."
                }
                Suspect::Geometry => {
                    "The geometry fails other tests, too, so the pair may be right. Add another pair to decide."
                }
            };
            format!("Point pair {pair} is {distance} off its epipolar line. {advice}")
        }
        Reason::Contradicted { contradicting, matches } => format!(
            "{contradicting} of {matches} distinctive matches are off their epipolar lines, \
             more than the eighth that a right geometry may leave. \
             Something in the scene moves, a lens bends the images, or the geometry is wrong. \
             Check the lines at points that you recognise."
        ),
        Reason::Fisheye => {
            "A strong lens, such as a fisheye, explains the matches clearly better than straight epipolar lines. \
             Points between the matches may be far off their lines. \
             Use the calibration of the lens, or undistort the images first."
                .into()
        }
        Reason::Pattern { size } => format!(
            "Neighbouring matches are off their epipolar lines by the same distance, about {size:.1} px. \
             A lens bends the images, something moves, or the geometry is only approximate. \
             Remove the lens distortion, or use images of a still scene."
        ),
        Reason::Ambiguous { margin } => {
            let support = if margin < 0.0 { "more" } else { "nearly as much" };
            format!(
                "A clearly different geometry has {support} support (lead of the result {:.0} %). \
                 Either may be right. Add a point pair to decide.",
                100.0 * margin
            )
        }
        Reason::OnePlane { percent, groups, agreeing, is_still } => {
            one_plane(percent, &off_the_plane(agreeing, groups), is_still)
        }
        Reason::NoRelief { along, across, on_warp } => no_relief(along, across, on_warp),
        Reason::OnlyTurned { along, across, turned } => only_turned(along, across, turned),
        Reason::BehindCameras { in_front, matches } => format!(
            "Only {in_front} of {matches} scene points lie in front of both cameras, where chance gives half. \
             The camera only turned, or the calibration is wrong, so the direction of the baseline is not determined. \
             Check the calibration, or use views from different places."
        ),
        Reason::Mirrored { matches } => format!(
            "{matches} places of the left image match the right one only if it is flipped, like a mirror image. \
             The epipolar geometry of such a pair says nothing about the cameras. \
             Flip one image back and open the pair again."
        ),
        Reason::Loose { deviation } => format!(
            "Even if the geometry is right, its matches leave the epipolar lines uncertain by {deviation:.1} px. \
             Add point pairs, or use images that overlap more."
        ),
        Reason::Untested { missing } => untested(missing).into(),
    }
}

/// Returns the reasons of a verdict, the most important first, and the number of misplaced pairs among them.
pub fn sorted_reasons(trust: &Trust) -> (Vec<&Reason>, usize) {
    let mut reasons: Vec<&Reason> = trust.reasons.iter().collect();
    reasons.sort_by(|a, b| {
        let ((group, worst), (other, its)) = (order(a), order(b));
        group.cmp(&other).then(worst.total_cmp(&its))
    });
    let misplaced = reasons.iter().filter(|reason| order(reason).0 == 0).count();
    (reasons, misplaced)
}

/// Returns the key by which reasons are sorted. A misplaced pair comes first: a person can mend it at once, and the
/// button is about it. Where the geometry is the likelier culprit, its other failed tests say why.
fn order(reason: &Reason) -> (i32, f64) {
    match *reason {
        Reason::ClickOff { suspect: Suspect::Click, distance, .. } => (0, -distance),
        Reason::ClickOff { suspect: Suspect::Geometry, distance, .. } => (2, -distance),
        Reason::GivenContradict { .. } | Reason::DifferentScenes { .. } => (-1, 0.0),
        // The words beside the verdict are about the epipole then.
        Reason::OnePlane { .. }
        | Reason::NoRelief { .. }
        | Reason::OnlyTurned { .. }
        | Reason::BehindCameras { .. } => (1, -1.0),
        _ => (1, 0.0),
    }
}

/// Returns a sentence if most of the pairs are misplaced: one that names a single pair would mislead.
pub fn mostly_misplaced(misplaced: usize, used: usize) -> Option<String> {
    (misplaced > 2 && 2 * misplaced > used).then(|| {
        format!(
            "{misplaced} of {used} point pairs are off their epipolar lines. \
             The images support the geometry, so these pairs are probably misplaced. \
             Leave them out, or check that both points show the same scene point."
        )
    })
}

/// Returns the message of a test that lacks its data.
fn untested(missing: Missing) -> &'static str {
    match missing {
        Missing::Precision => {
            "Too few matches or frames tell how precise the epipolar lines are. \
             Matching points may be far off their lines. Give more of them."
        }
        Missing::Neighbours => {
            "No matches are near each other, so nothing tests whether a lens bends the images. \
             Matching points may be off their lines. Give more matches."
        }
        // The others have reasons of their own.
        Missing::Relief | Missing::Patches | Missing::Refinement | Missing::Matches | Missing::Agreement => {
            "Too few matches test whether a flat scene or a turned camera explains them all. \
             The epipole may be wrong. Give more matches, spread over both images."
        }
    }
}

/// Returns the message if matches beside a smooth warp are too few or do not confirm the epipole.
fn no_relief(along: usize, across: usize, on_warp: usize) -> String {
    let all = along + across + on_warp;
    if on_warp <= along + across {
        return format!(
            "The epipole is not determined, because too few distinctive matches confirm it: {along} of {all}. \
             {} it. Use images that overlap more.",
            contradicting(across)
        );
    }
    format!(
        "{on_warp} of {all} distinctive matches follow one smooth warp, as with a flat scene or a turned camera. \
         {} Use views from different places, or a scene with more depth.",
        others("the epipole", along, across, on_warp)
    )
}

/// Returns the message if matches beside a turn of the camera are too few or do not confirm the baseline.
fn only_turned(along: usize, across: usize, turned: usize) -> String {
    format!(
        "{turned} of {} distinctive matches follow a camera that only turned. {} Use views from different places.",
        along + across + turned,
        others("the direction of the baseline", along, across, turned)
    )
}

/// Returns why the matches beside a warp or a turn do not confirm something.
fn others(what: &str, along: usize, across: usize, on_warp: usize) -> String {
    match Lack::of(on_warp, along, across) {
        Lack::Matches => {
            let percent = 100.0 * along as f64 / (along + across + on_warp).max(1) as f64;
            format!("Only {along} others confirm {what}, {percent:.1} % of all, and 5 % are needed.")
        }
        Lack::Agreement => format!(
            "Of the {} others, {along} confirm {what}, and clearly more than three in four have to.",
            along + across
        ),
        Lack::Significance => {
            format!(
                "{along} others confirm {what}, but more are off their lines, or chance explains as many."
            )
        }
    }
}

fn contradicting(matches: usize) -> String {
    match matches {
        0 => "None contradicts".into(),
        1 => "1 contradicts".into(),
        _ => format!("{matches} contradict"),
    }
}

/// Returns the message if a plane explains the matches, or if the camera stood still.
fn one_plane(percent: u32, off_the_plane: &str, is_still: bool) -> String {
    if is_still {
        return format!(
            "{percent} % of the matches are at the same place in both images, as if the camera stood still. \
             Things that moved by themselves do not show the epipole. \
             Use views from different places."
        );
    }
    format!(
        "{percent} % of the matches fit one plane or a rotation of the camera, \
         and the others do not determine the epipole. \
         {off_the_plane} Use views from other places, or a scene with more depth."
    )
}

/// Returns a sentence on whether the matches off the plane confirm the epipole.
fn off_the_plane(agreeing: usize, groups: usize) -> String {
    match (agreeing, groups) {
        (_, 0) => "No match off the plane confirms it.".into(),
        (0, 1) => "The one group of matches off the plane contradicts it.".into(),
        (0, _) => format!("All {groups} groups of matches off the plane contradict it."),
        (1, 1) => "The epipole fits the one group of matches off the plane, which may be chance.".into(),
        _ => format!(
            "The epipole fits {agreeing} of {groups} groups of matches off the plane, too few to be sure."
        ),
    }
}

/// Returns the message of a warning, with pairs by their numbers.
pub fn warning_in_words(warning: &Warning) -> String {
    named_warning_in_words(warning, &PairNumbers)
}

/// Returns the message of a warning, with names of pairs.
pub fn named_warning_in_words(warning: &Warning, names: &dyn PairNames) -> String {
    match *warning {
        Warning::SameEpipolarLine { distance } => format!(
            "Two point pairs lie nearly on one epipolar line, only {distance:.1} px apart across it. \
             On their own, they hardly determine where the lines meet. \
             Move one of them away from the line of the other."
        ),
        Warning::CloseClicks { distance } => format!(
            "Two point pairs are only {distance:.0} px apart. \
             A small error in one of them turns the epipolar lines a lot. Choose points farther apart."
        ),
        Warning::LittleTexture { pair, textured, lines } => format!(
            "Only {textured} of {lines} lines through point pair {} have texture. \
             The others cannot be compared. Choose a point in a textured part of the images.",
            names.name(pair)
        ),
        Warning::CalibrationContradicted => "The matches contradict the calibration, so the geometry was fitted \
             without it. A pose from this calibration is wrong. Check the focal lengths and the size of the images."
            .into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns examples of all reasons. `docs/verdicts.md` has the first example of each reason.
    fn reasons() -> Vec<Reason> {
        vec![
            Reason::NotChecked,
            Reason::NotRefined,
            Reason::RefinementOff,
            Reason::ClicksAlone,
            Reason::PointsAlone { agreeing: 11, matches: 12 },
            Reason::PointsByChance { agreeing: 8, matches: 20 },
            Reason::GivenAlone { matches: 16 },
            Reason::GivenContradict { contradicting: 54, matches: 54, distance: 8.4 },
            Reason::DifferentScenes { agreeing: 3, by_chance: 16, matches: 273 },
            Reason::FewMatches { matches: 17 },
            Reason::ByChance { agreeing: 9, matches: 140 },
            Reason::BarcodesByChance { correlation: 0.21, by_chance: 0.21 },
            Reason::FewBarcodes { lines: 11 },
            Reason::LooseBarcodes { deviation: 2.7 },
            Reason::ClickOff { pair: 2, distance: 13.9, suspect: Suspect::Click },
            Reason::ClickOff { pair: 2, distance: 40.0, suspect: Suspect::Geometry },
            Reason::Contradicted { contradicting: 107, matches: 180 },
            Reason::Fisheye,
            Reason::Pattern { size: 0.8 },
            Reason::Ambiguous { margin: 0.02 },
            Reason::OnePlane { percent: 98, groups: 13, agreeing: 4, is_still: false },
            Reason::OnePlane { percent: 98, groups: 0, agreeing: 0, is_still: false },
            Reason::OnePlane { percent: 98, groups: 1, agreeing: 0, is_still: false },
            Reason::OnePlane { percent: 98, groups: 1, agreeing: 1, is_still: false },
            Reason::OnePlane { percent: 98, groups: 12, agreeing: 0, is_still: false },
            Reason::OnePlane { percent: 88, groups: 8, agreeing: 8, is_still: true },
            Reason::NoRelief { along: 12, across: 9, on_warp: 480 },
            Reason::NoRelief { along: 16, across: 4, on_warp: 5 },
            Reason::OnlyTurned { along: 12, across: 9, turned: 480 },
            Reason::BehindCameras { in_front: 1013, matches: 1959 },
            Reason::Mirrored { matches: 212 },
            Reason::Loose { deviation: 2.0 },
            Reason::Untested { missing: Missing::Relief },
            Reason::Untested { missing: Missing::Precision },
            Reason::Untested { missing: Missing::Neighbours },
        ]
    }

    /// Returns examples of all warnings. `docs/verdicts.md` has all of them.
    fn warnings() -> Vec<Warning> {
        vec![
            Warning::SameEpipolarLine { distance: 0.5 },
            Warning::CloseClicks { distance: 48.0 },
            Warning::LittleTexture { pair: 1, textured: 33, lines: 171 },
            Warning::CalibrationContradicted,
        ]
    }

    /// Returns the names of the variants of an enumeration, read from its source.
    fn variants<'a>(source: &'a str, name: &str) -> Vec<&'a str> {
        let body = source.split(&format!("pub enum {name} {{")).nth(1).unwrap();
        let body = body.split("\n}").next().unwrap();
        let is_variant = |line: &&str| line.as_bytes().get(4).is_some_and(u8::is_ascii_uppercase);
        body.lines().filter(is_variant).filter_map(|line| line.trim().split([',', ' ']).next()).collect()
    }

    /// Returns a name of the source in the form of result files: `few-matches` for `FewMatches`.
    fn in_files(name: &str) -> String {
        let mut text = String::new();
        for letter in name.chars() {
            if letter.is_ascii_uppercase() && !text.is_empty() {
                text.push('-');
            }
            text.push(letter.to_ascii_lowercase());
        }
        text
    }

    #[test]
    fn the_document_explains_every_message() {
        let document = include_str!("../../docs/verdicts.md");
        let words: Vec<&str> = document.split_whitespace().filter(|word| *word != ">").collect();
        let text = words.join(" ");
        let mut reasons = reasons();
        reasons.dedup_by_key(|reason| std::mem::discriminant(reason));
        let messages = reasons.iter().map(reason_in_words);
        for message in messages.chain(warnings().iter().map(warning_in_words)) {
            assert!(text.contains(&message), "docs/verdicts.md lacks: {message}");
        }
        let reason_names = variants(include_str!("../estimate/verdict/trust/mod.rs"), "Reason");
        let warning_names = variants(include_str!("../estimate/error.rs"), "Warning");
        assert_eq!((reason_names.len(), warning_names.len()), (reasons.len(), warnings().len()));
        for name in reason_names.into_iter().chain(warning_names) {
            let heading = format!("\n### `{}`\n", in_files(name));
            assert!(document.contains(&heading), "docs/verdicts.md lacks the section of {name}");
        }
    }

    #[test]
    fn every_message_has_at_most_three_short_sentences() {
        let (reasons, warnings) = (reasons(), warnings());
        let messages = reasons.iter().map(reason_in_words).chain(warnings.iter().map(warning_in_words));
        for message in messages {
            assert!(message.ends_with('.') && !message.contains("  "), "{message}");
            let sentences: Vec<&str> = message.split(". ").collect();
            assert!(sentences.len() <= 3, "{message}");
            for sentence in sentences {
                assert!(sentence.split(' ').count() <= 25, "{sentence}");
                assert!(sentence.starts_with(|c: char| c.is_uppercase() || c.is_ascii_digit()), "{sentence}");
            }
        }
    }

    #[test]
    fn matches_beside_a_warp_lack_number_agreement_or_significance() {
        let words = |along, across, on_warp| reason_in_words(&Reason::NoRelief { along, across, on_warp });
        assert!(
            words(45, 1, 900)
                .contains("Only 45 others confirm the epipole, 4.8 % of all, and 5 % are needed.")
        );
        assert!(words(36, 16, 60).contains("Of the 52 others, 36 confirm the epipole"));
        assert!(words(45, 1, 400).contains("45 others confirm the epipole, but more are off their lines"));
    }

    #[test]
    fn a_rival_with_more_support_is_called_that() {
        let rival = |margin| reason_in_words(&Reason::Ambiguous { margin });
        assert!(rival(0.1).contains("nearly as much support (lead of the result 10 %)"), "{}", rival(0.1));
        assert!(rival(-0.96).contains("has more support (lead of the result -96 %)"), "{}", rival(-0.96));
    }
}
