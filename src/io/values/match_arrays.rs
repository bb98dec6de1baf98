//! Matches in arrays that have the names of matchers: in NumPy archives, and in JSON and YAML. Of several pairs of
//! arrays, the first in the order of [`Kind`] is read; the note says which.

use super::match_names::{Kind, PointsName, concerns_matches, names_matches, names_scores};
use super::matrix_name::name_parts;
use crate::estimate::Match;
use crate::geometry::{Point, PointPair};
use crate::io::npy::Array;
use crate::io::point_pairs::{check_more_columns, first_four};

/// Smallest prior of a match: a score of zero does not exclude it.
const LEAST_PRIOR: f64 = 0.01;

/// Name and content of an array, or the reason why it cannot be read.
pub(in crate::io) type NamedArray = (String, Result<Array, String>);

/// Matches of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::io) struct FoundMatches {
    pub matches: Vec<Match>,
    /// Clauses about what was read and what was left out.
    pub notes: Vec<String>,
}

/// Returns the matches of named arrays; `None` without any.
pub(in crate::io) fn matches_of(arrays: &[NamedArray]) -> Result<Option<FoundMatches>, String> {
    let mut notes = Vec::new();
    let read = |name: &str| {
        arrays.iter().find(|(other, _)| other == name).map(|(_, array)| named(name, array)).transpose()
    };
    for name in ["batch_indexes", "batch_indices"] {
        if let Some(batch) = read(name)?
            && batch.numbers.iter().any(|number| number - batch.numbers[0] != 0.0)
        {
            return Err(format!(
                "it has the matches of several image pairs ({name}). Save the matches of one"
            ));
        }
    }
    let indices = arrays.iter().find(|(name, array)| {
        names_matches(name) && array.as_ref().is_ok_and(|array| array.batchless().last() != Some(&4))
    });
    let (mut candidates, alone) = candidates(arrays)?;
    candidates.sort_by_key(|candidate| candidate.kind);
    let is_usable = |kind: Kind| match kind {
        Kind::All => indices.is_some(),
        Kind::Coarse | Kind::Scaled => false,
        _ => true,
    };
    let chosen = candidates.iter().find(|candidate| is_usable(candidate.kind));
    if let Some((name, kind)) = alone
        && chosen.is_none_or(|chosen| kind < chosen.kind)
    {
        return Err(format!("there is {name}, but no array of the same name for the other image"));
    }
    let score_names: Vec<&NamedArray> = arrays.iter().filter(|(name, _)| names_scores(name)).collect();
    let mut scores: Vec<(&str, &Array)> = Vec::new();
    for (name, array) in score_names {
        scores.push((name, named(name, array)?));
    }
    let (pairs, origin) = if let Some(chosen) = chosen {
        let [first, second] = chosen.names;
        let (one, two) =
            (points(first, read(first)?, &mut notes)?, points(second, read(second)?, &mut notes)?);
        let others: Vec<&str> =
            candidates.iter().filter(|other| other.names != chosen.names).map(|c| c.names[0]).collect();
        if !others.is_empty() {
            notes.push(format!("{first} and {second} were read, {} not", others.join(", ")));
        }
        match indices.filter(|_| matches!(chosen.kind, Kind::KeypointsOriginal | Kind::Keypoints | Kind::All))
        {
            Some((name, array)) => indexed(&one, &two, name, named(name, array)?)?,
            None if one.len() != two.len() => {
                return Err(format!(
                    "{first} has {} points and {second} {}. Without an array matches, their numbers must be equal",
                    one.len(),
                    two.len()
                ));
            }
            None => {
                if matches!(chosen.kind, Kind::KeypointsOriginal | Kind::Keypoints) {
                    check_matched(arrays, first)?;
                    notes.push(format!("row k of {first} was matched with row k of {second}"));
                }
                let origin = Origin::listed(one.len());
                (
                    one.into_iter().zip(two).map(|(point1, point2)| PointPair { point1, point2 }).collect(),
                    origin,
                )
            }
        }
    } else if let Some(found) = in_one_array(arrays, &mut notes)? {
        let origin = Origin::listed(found.len());
        (found, origin)
    } else if let Some(unusable) = candidates.first() {
        let [first, _] = unusable.names;
        return Err(match unusable.kind {
            Kind::Coarse => format!(
                "{first} is on the coarse grid of the matcher. Save its fine matches (mkpts0_f, mkpts1_f)"
            ),
            Kind::Scaled => format!("{first} is not in pixels of the pictures. Save the points in pixels"),
            _ => format!("{first} has all keypoints, and there is no array matches. Save the matched points"),
        });
    } else {
        return Ok(None);
    };
    check_pixels(&pairs)?;
    let deviations = match ["covariances", "covariance"].into_iter().find_map(|name| read(name).transpose()) {
        Some(array) if array.as_ref().is_ok_and(|array| array.shape.len() == 3) => {
            Some(deviations(array?, pairs.len())?)
        }
        _ => None,
    };
    let priors = priors(&scores, &origin, &mut notes);
    let matches = pairs.iter().enumerate().map(|(k, pair)| Match {
        pair: *pair,
        sigma: deviations.as_ref().map_or(1.0, |deviations| deviations[k]),
        prior: priors.as_ref().map_or(1.0, |priors| priors[k]),
    });
    Ok(Some(FoundMatches { matches: matches.collect(), notes }))
}

fn named<'a>(name: &str, array: &'a Result<Array, String>) -> Result<&'a Array, String> {
    array.as_ref().map_err(|problem| format!("{name}: {problem}"))
}

/// Where the matches come from, for arrays beside them.
struct Origin {
    /// Row of the indices and first keypoint of each match.
    rows: Vec<[usize; 2]>,
    /// Number of rows of indices.
    indices: usize,
    /// Number of first keypoints.
    keypoints: usize,
}

impl Origin {
    /// Creates the origin of matches that are listed themselves.
    fn listed(count: usize) -> Self {
        Self { rows: (0..count).map(|k| [k, k]).collect(), indices: count, keypoints: count }
    }
}

/// Array of points without a partner.
type Alone<'a> = Option<(&'a str, Kind)>;

/// Two arrays of points.
struct Candidate<'a> {
    kind: Kind,
    names: [&'a str; 2],
}

/// Returns the pairs of arrays whose names differ in the image alone.
/// Returns an array without a partner, too.
fn candidates(arrays: &[NamedArray]) -> Result<(Vec<Candidate<'_>>, Alone<'_>), String> {
    let named: Vec<(&str, PointsName)> =
        arrays.iter().filter_map(|(name, _)| Some((&**name, PointsName::of(name)?))).collect();
    let mut found: Vec<Candidate<'_>> = Vec::new();
    let mut alone: Option<(&str, Kind)> = None;
    for (name, points) in &named {
        let same: Vec<&(&str, PointsName)> = named
            .iter()
            .filter(|(other, with)| with.kind == points.kind && without_side(other) == without_side(name))
            .collect();
        match same[..] {
            [one, two] if one.1.side != two.1.side => {
                let names = if one.1.side < two.1.side { [one.0, two.0] } else { [two.0, one.0] };
                if found.iter().all(|candidate| candidate.names != names) {
                    found.push(Candidate { kind: points.kind, names });
                }
            }
            [_] if alone.is_none_or(|(_, kind)| points.kind < kind) => alone = Some((name, points.kind)),
            [_] => {}
            _ => {
                return Err(format!(
                    "the arrays like {name} are not those of two images. Save the points of two"
                ));
            }
        }
    }
    Ok((found, alone))
}

/// Refuses keypoints as matches beside arrays that tell of other matches, or of features.
fn check_matched(arrays: &[NamedArray], points: &str) -> Result<(), String> {
    let tells = |name: &str| {
        let name = name.to_lowercase();
        name.contains("match") || name.contains("descriptor") || name.contains("desc0")
    };
    let other =
        arrays.iter().map(|(name, _)| name).find(|name| PointsName::of(name).is_none() && tells(name));
    other.map_or(Ok(()), |other| {
        Err(format!(
            "{points} may have all keypoints, as {other} stands beside it. Save their indices as matches"
        ))
    })
}

/// Returns a name without the word or digit of the image.
fn without_side(name: &str) -> String {
    let sides = ["left", "l", "a", "src", "right", "r", "b", "dst", "tgt"];
    let parts =
        name_parts(name).into_iter().map(|part| part.trim_end_matches(['0', '1', '2']).to_lowercase());
    parts.filter(|part| !part.is_empty() && !sides.contains(&&**part)).collect::<Vec<_>>().join("_")
}

/// Returns the points of an array: N×2, 2×N, N×1×2, with a leading 1 of a batch; of more columns the first two.
fn points(name: &str, array: Option<&Array>, notes: &mut Vec<String>) -> Result<Vec<Point>, String> {
    let array = array.ok_or_else(|| format!("{name} is missing"))?;
    let shape = array.batchless();
    let wrong =
        || format!("{name} has the shape {}, expected N×2 finite numbers", shape_in_words(&array.shape));
    if array.numbers.iter().any(|number| !number.is_finite()) {
        return Err(wrong());
    }
    let columns = match shape {
        [_, 2] | [_, 1, 2] => 2,
        [2, count] if *count > 4 => {
            let (x, y) = array.numbers.split_at(*count);
            notes.push(format!("{name} was read as a row of x and a row of y"));
            return Ok(x.iter().zip(y).map(|(x, y)| Point::new(*x, *y)).collect());
        }
        [_, columns] if *columns > 2 => {
            let is_homogeneous = *columns == 3 && array.rows(3).all(|row| row[2] - 1.0 == 0.0);
            if !is_homogeneous {
                notes.push(format!("of {columns} columns of {name} the first two were read as x and y"));
            }
            *columns
        }
        _ => return Err(wrong()),
    };
    Ok(array.rows(columns).map(|row| Point::new(row[0], row[1])).collect())
}

pub(in crate::io) fn shape_in_words(shape: &[usize]) -> String {
    shape.iter().map(ToString::to_string).collect::<Vec<_>>().join("×")
}

/// Returns the rows of coordinates of an array with the name of matches, or of the only array.
fn in_one_array(arrays: &[NamedArray], notes: &mut Vec<String>) -> Result<Option<Vec<PointPair>>, String> {
    let by_name = arrays.iter().find(|(name, _)| names_matches(name));
    let of_four = |(_, array): &&NamedArray| {
        array
            .as_ref()
            .is_ok_and(|array| matches!(array.batchless(), [_, 4] | [_, 2, 2]) && array.batchless()[0] != 3)
    };
    let by_shape: Vec<&NamedArray> =
        arrays.iter().filter(of_four).filter(|(name, _)| !concerns_matches(name)).collect();
    let (name, array) = match (by_name, &by_shape[..], arrays) {
        (Some(found), _, _) => found,
        // A file with one array needs no name.
        (None, _, [only @ (name, Ok(array))]) if name.is_empty() && array.numbers.len() != 9 => only,
        (None, [only], _) => only,
        _ => return Ok(None),
    };
    pairs_in(name, named(name, array)?, notes).map(Some)
}

/// Returns the pairs of an array: rows of x1 y1 x2 y2 and perhaps more, or N×2×2.
pub(in crate::io) fn pairs_in(
    name: &str,
    array: &Array,
    notes: &mut Vec<String>,
) -> Result<Vec<PointPair>, String> {
    let columns = match array.batchless() {
        [_, 2, 2] => 4,
        [_, columns] if *columns >= 4 => *columns,
        _ => {
            let name = if name.is_empty() { "the array" } else { name };
            return Err(format!(
                "{name} has the shape {}, expected 3×3 for a fundamental matrix, or N×4 or N×2×2 for point pairs",
                shape_in_words(&array.shape)
            ));
        }
    };
    if columns > 4 {
        let rows: Vec<&[f64]> = array.rows(columns).collect();
        check_more_columns(&rows)?;
        notes.push(first_four(columns));
    }
    if array.rows(columns).any(|row| row[..4].iter().any(|number| !number.is_finite())) {
        return Err("some coordinates are not finite numbers".to_owned());
    }
    Ok(array.rows(columns).map(|row| PointPair::new(row[0], row[1], row[2], row[3])).collect())
}

/// Refuses coordinates that are not in pixels: all of them within one pixel of the corner.
pub(in crate::io) fn check_pixels(pairs: &[PointPair]) -> Result<(), String> {
    let is_small = |pair: &PointPair| pair.numbers().iter().all(|number| number.abs() <= 1.0);
    if pairs.len() > 1 && pairs.iter().all(is_small) {
        return Err(
            "all coordinates are between -1 and 1, so they are not in pixels. Multiply them by the size of the pictures"
                .to_owned(),
        );
    }
    Ok(())
}

/// Returns the matched keypoints, and the rows of both. Matches are rows of two indices, or one index for each first
/// keypoint, −1 for none.
fn indexed(
    first: &[Point],
    second: &[Point],
    name: &str,
    matches: &Array,
) -> Result<(Vec<PointPair>, Origin), String> {
    let shape = matches.batchless();
    let indices: Vec<[f64; 2]> = match shape {
        [1, count] if *count == first.len() => {
            matches.numbers.iter().enumerate().map(|(k, j)| [k as f64, *j]).collect()
        }
        [_, 2] => matches.rows(2).map(|row| [row[0], row[1]]).collect(),
        [count] if *count == first.len() => {
            matches.numbers.iter().enumerate().map(|(k, index)| [k as f64, *index]).collect()
        }
        _ => {
            return Err(format!(
                "{name} has the shape {}, expected N×2 or one index for each of {} keypoints",
                shape_in_words(&matches.shape),
                first.len()
            ));
        }
    };
    if indices.iter().flatten().any(|index| index.fract() != 0.0) {
        return Err(format!("{name} has no indices of keypoints, but other numbers"));
    }
    let (mut pairs, mut rows) = (Vec::new(), Vec::new());
    for (k, [i, j]) in indices.iter().enumerate().filter(|(_, [i, j])| *i >= 0.0 && *j >= 0.0) {
        let (Some(point1), Some(point2)) = (first.get(*i as usize), second.get(*j as usize)) else {
            return Err(format!("match {} names keypoints {i} and {j}, which do not exist", k + 1));
        };
        pairs.push(PointPair { point1: *point1, point2: *point2 });
        rows.push([k, *i as usize]);
    }
    Ok((pairs, Origin { rows, indices: indices.len(), keypoints: first.len() }))
}

/// Returns the prior of each match by scores from 0 to 1: one for each match, each row of indices or each first
/// keypoint.
fn priors(scores: &[(&str, &Array)], origin: &Origin, notes: &mut Vec<String>) -> Option<Vec<f64>> {
    for (name, array) in scores {
        let (numbers, count) = (&array.numbers, array.numbers.len());
        let of_keypoints = count == origin.keypoints && *name == "matching_scores0";
        let at: Option<fn(usize, &[usize; 2]) -> usize> = match () {
            () if of_keypoints => Some(|_, row| row[1]),
            () if count == origin.rows.len() => Some(|k, _| k),
            () if count == origin.indices => Some(|_, row| row[0]),
            () if count == origin.keypoints => Some(|_, row| row[1]),
            () => None,
        };
        let Some(at) = at else {
            notes.push(format!(
                "{name} has {count} numbers for {} matches and was left out",
                origin.rows.len()
            ));
            continue;
        };
        let found: Vec<f64> = origin.rows.iter().enumerate().map(|(k, row)| numbers[at(k, row)]).collect();
        if found.iter().any(|score| *score < 0.0 || *score > 1.0) {
            notes.push(format!("{name} is not between 0 and 1 and was left out"));
            continue;
        }
        let prior = |score: f64| if score.is_finite() { score.max(LEAST_PRIOR) } else { 1.0 };
        return Some(found.into_iter().map(prior).collect());
    }
    None
}

/// Returns the standard deviations of N×2×2 covariances in units of their median.
fn deviations(array: &Array, count: usize) -> Result<Vec<f64>, String> {
    if array.shape != [count, 2, 2] {
        return Err(format!(
            "covariances has the shape {}, expected {count}×2×2",
            shape_in_words(&array.shape)
        ));
    }
    let deviation = |c: &[f64]| (0.5 * (c[0] + c[3])).sqrt();
    let all: Vec<f64> = array.numbers.chunks_exact(4).map(deviation).collect();
    if !all.iter().all(|d| d.is_finite() && *d > 0.0) {
        return Err("some covariances are not positive".into());
    }
    let typical = crate::geometry::median(all.iter().copied());
    Ok(all.into_iter().map(|d| d / typical).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(name: &str, shape: &[usize], numbers: &[f64]) -> NamedArray {
        (name.to_owned(), Ok(Array { shape: shape.to_vec(), numbers: numbers.to_vec() }))
    }

    fn read(arrays: &[NamedArray]) -> Result<FoundMatches, String> {
        matches_of(arrays).map(|found| found.expect("matches"))
    }

    #[test]
    fn names_of_todays_matchers_are_known() {
        let (one, two) = ([1.0, 2.0, 30.0, 4.0], [11.0, 12.0, 13.0, 14.0]);
        for (first, second) in [
            ("mkpts0", "mkpts1"),
            ("mkpts_0", "mkpts_1"),
            ("mkpts0_f", "mkpts1_f"),
            ("matched_kpts0", "matched_kpts1"),
            ("inlier_kpts0", "inlier_kpts1"),
            ("mkeypoints0_orig", "mkeypoints1_orig"),
            ("m_kpts0", "m_kpts1"),
            ("kpts1", "kpts2"),
            ("keypoints0", "keypoints1"),
            ("pts1", "pts2"),
            ("points_left", "points_right"),
            ("matchedPoints1", "matchedPoints2"),
            ("inlierPts1", "inlierPts2"),
            ("src_pts", "dst_pts"),
            ("mkps0", "mkps1"),
        ] {
            // The order in the file has no meaning.
            let found = read(&[array(second, &[2, 2], &two), array(first, &[1, 2, 2], &one)]);
            let pairs: Vec<_> =
                found.unwrap_or_else(|e| panic!("{first}: {e}")).matches.iter().map(|m| m.pair).collect();
            assert_eq!(
                pairs,
                [PointPair::new(1.0, 2.0, 11.0, 12.0), PointPair::new(30.0, 4.0, 13.0, 14.0)],
                "{first}"
            );
        }
    }

    #[test]
    fn of_several_arrays_one_is_chosen_and_named() {
        let of = |name: &str, x: f64| {
            ["0", "1"].map(|side| array(&name.replace('#', side), &[2, 2], &[x, 2.0, x + 1.0, 4.0]))
        };
        let all = [of("all_kpts#", 1.0), of("inlier_kpts#", 2.0), of("mkpts#_f", 3.0), of("mkpts#_c", 4.0)];
        let found = read(&all.concat()).unwrap();
        assert_eq!(found.matches[0].pair.point1, Point::new(3.0, 2.0));
        assert!(found.notes[0].starts_with("mkpts0_f and mkpts1_f were read"), "{:?}", found.notes);
        for (arrays, told) in [
            (of("mkpts#_c", 4.0).to_vec(), "coarse grid"),
            (of("all_kpts#", 4.0).to_vec(), "all keypoints"),
            (of("kpts#_norm", 40.0).to_vec(), "not in pixels"),
            (of("mkpts#", 40.0)[..1].to_vec(), "no array of the same name"),
            (
                of("mkpts#", -0.5)
                    .map(|(name, a)| (name, a.map(|a| Array { numbers: vec![0.1; 4], ..a })))
                    .to_vec(),
                "between -1 and 1",
            ),
            (vec![array("kpts0", &[3, 2], &[9.0; 6]), array("kpts1", &[2, 2], &[9.0; 4])], "must be equal"),
            (
                [&of("kpts#", 5.0)[..], &[array("batch_indexes", &[2], &[0.0, 1.0])]].concat(),
                "several image pairs",
            ),
        ] {
            let problem = read(&arrays).unwrap_err();
            assert!(problem.contains(told), "{problem}");
        }
    }

    #[test]
    fn indices_and_scores_belong_to_keypoints_or_matches() {
        let keypoints = [
            array("keypoints0", &[3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            array("keypoints1", &[1, 2, 2], &[11.0, 12.0, 13.0, 14.0]),
        ];
        let of = |rest: &[NamedArray]| read(&[&keypoints[..], rest].concat());
        let rows =
            of(&[array("matches", &[2, 2], &[0.0, 1.0, 2.0, 0.0]), array("scores", &[2], &[0.9, 0.0])])
                .unwrap();
        assert_eq!(rows.matches[0].pair, PointPair::new(1.0, 2.0, 13.0, 14.0));
        assert!((rows.matches[0].prior - 0.9).abs() < 1e-9 && rows.matches[1].prior > 0.0);
        // One index for each keypoint, with a confidence for each keypoint.
        let list = of(&[
            array("matches", &[3], &[-1.0, 0.0, -1.0]),
            array("match_confidence", &[3], &[0.0, 0.5, 0.0]),
        ]);
        assert_eq!(
            list.unwrap().matches,
            [Match { prior: 0.5, ..PointPair::new(3.0, 4.0, 11.0, 12.0).into() }]
        );
        let other = of(&[array("matches", &[1, 2], &[0.0, 1.0]), array("scores", &[7], &[1.0; 7])]).unwrap();
        assert!(other.notes[0].contains("scores has 7 numbers for 1 matches"), "{:?}", other.notes);
        for (rest, told) in [
            (array("matches", &[1, 2], &[0.0, 7.0]), "do not exist"),
            (array("matches", &[1, 5], &[0.0; 5]), "shape 1×5"),
            (array("matches", &[1, 2], &[0.5, 1.0]), "no indices"),
        ] {
            let problem = of(&[rest]).unwrap_err();
            assert!(problem.contains(told), "{problem}");
        }
    }

    #[test]
    fn rows_of_four_come_in_many_shapes() {
        let four = [1.0, 2.0, 30.0, 4.0, 5.0, 6.0, 7.0, 8.5];
        for (name, shape) in [("x", vec![2, 4]), ("x", vec![2, 2, 2]), ("matches", vec![1, 2, 4])] {
            let found = read(&[array(name, &shape, &four)]).unwrap();
            assert_eq!(found.matches[1].pair, PointPair::new(5.0, 6.0, 7.0, 8.5));
        }
        let more =
            read(&[array("matches", &[2, 5], &[1.5, 2.0, 30.0, 4.0, 0.7, 5.0, 6.0, 7.0, 8.0, 0.9])]).unwrap();
        assert_eq!(more.matches[1].pair, PointPair::new(5.0, 6.0, 7.0, 8.0));
        assert!(more.notes[0].contains("of 5 columns the first four"), "{:?}", more.notes);
    }

    /// A file with a name changed or an array less gives the same matches or a sentence, never other matches.
    #[test]
    fn changed_names_never_give_other_matches() {
        let keypoints = |name: &str, x: f64| array(name, &[3, 2], &[x, 2.0, x + 30.0, 4.0, x + 60.0, 9.0]);
        let files = [
            vec![
                keypoints("keypoints0", 1.0),
                keypoints("keypoints1", 7.0),
                array("matches", &[3], &[2.0, -1.0, 0.0]),
            ],
            vec![
                keypoints("keypoints0", 1.0),
                keypoints("keypoints1", 7.0),
                array("matches0", &[3], &[2.0, -1.0, 0.0]),
                array("matching_scores0", &[3], &[0.5, 0.0, 0.6]),
            ],
            vec![
                keypoints("keypoints0", 1.0),
                keypoints("keypoints1", 7.0),
                array("mkpts0_f", &[1, 2], &[1.0, 2.0]),
                array("mkpts1_f", &[1, 2], &[37.0, 4.0]),
                array("mconf", &[1], &[0.7]),
            ],
        ];
        for file in &files {
            let pairs = |found: FoundMatches| found.matches.iter().map(|m| m.pair).collect::<Vec<_>>();
            let expected = pairs(read(file).unwrap());
            for k in 0..file.len() {
                let mut less = file.clone();
                let _ = less.remove(k);
                let mut renamed = file.clone();
                renamed[k].0 = format!("x{}", file[k].0);
                for changed in [less, renamed] {
                    if changed.iter().any(|(name, _)| name.contains("match") || name.contains("mkpts"))
                        && let Ok(Some(found)) = matches_of(&changed)
                    {
                        assert_eq!(
                            pairs(found),
                            expected,
                            "{:?}",
                            changed.iter().map(|a| &a.0).collect::<Vec<_>>()
                        );
                    }
                }
            }
        }
    }
}
