//! Disparities of a rectified pair in words, with the range for block matchers.

/// Step of disparity ranges, px, as block matchers require.
const RANGE_STEP: f64 = 16.0;
/// Margin added to the disparities of the matches on either side, px, as other points may lie
/// beyond.
const RANGE_MARGIN: f64 = 4.0;

/// Returns the suggested search range around the disparities of matches, px.
pub fn search_range_in_words([low, high]: [f64; 2]) -> String {
    let from = ((low - RANGE_MARGIN) / RANGE_STEP).floor() * RANGE_STEP;
    let to = ((high + RANGE_MARGIN) / RANGE_STEP).ceil() * RANGE_STEP;
    format!("Suggested search range: {} to {} px", pixels_in_words(from), pixels_in_words(to))
}

/// Returns whole pixels with a sign. The minus sign is as wide as the plus sign, and zero has none.
pub fn pixels_in_words(value: f64) -> String {
    format!("{:.0}", value.round() + 0.0).replace('-', "−")
}

/// Describes the range of the disparities of matches, px, and the range to search. Built-in pictures cannot be swapped.
pub fn disparities_in_words([low, high]: [f64; 2], can_swap: bool) -> String {
    let advice = if can_swap { "use the command Swap the images" } else { "set a negative minimum" };
    let sign = if high <= 0.0 {
        format!("For programs that expect positive disparities, {advice}. ")
    } else if low + high >= 0.0 {
        String::new()
    } else {
        format!("Most are negative. For programs that expect positive ones, {advice}. ")
    };
    let range = search_range_in_words([low, high]);
    let [low, high] = [low, high].map(pixels_in_words);
    format!("Disparities of matches {low} to {high} px. {sign}{range}.")
}

/// Warning beside a disparity map that most known matches contradict.
pub const WRONG_PREVIEW: &str =
    "Most of this preview is wrong: brightness along the rows does not tell the disparities here.";

/// Describes a disparity map: its range, px, the share of the picture with a match, and of the known matches that agree.
pub fn preview_in_words(range: [f64; 2], matched: f64, agreeing: Option<f64>) -> String {
    let [low, high] = range.map(pixels_in_words);
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let agree =
        agreeing.map_or_else(String::new, |share| format!(", {} of the known matches agree", percent(share)));
    format!("Disparity preview: {low} to {high} px, {} matched{agree}", percent(matched))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hint_gives_a_search_range_and_asks_for_a_swap_if_negative() {
        let text = disparities_in_words([-12.0, 87.0], true);
        assert_eq!(text, "Disparities of matches −12 to 87 px. Suggested search range: −16 to 96 px.");
        let text = disparities_in_words([-90.4, -14.2], true);
        assert!(text.contains("Swap the images") && text.ends_with("range: −96 to 0 px."), "{text}");
        let text = disparities_in_words([-90.4, -14.2], false);
        assert!(text.contains("set a negative minimum") && !text.contains("Swap"), "{text}");
        let told = preview_in_words([-3.2, 40.0], 0.72, Some(0.34));
        assert_eq!(told, "Disparity preview: −3 to 40 px, 72 % matched, 34 % of the known matches agree");
        assert!(preview_in_words([0.0, 40.0], 0.72, None).ends_with("matched"));
    }
}
