//! Sentences for the errors of an estimate: the fact, the consequence and the action.

use std::f64::consts::PI;

use crate::estimate::{EstimateError, PairNames, PairNumbers};

/// Returns the message of an error, with pairs by their numbers and without a full stop at its end.
pub fn error_in_words(error: &EstimateError) -> String {
    named_error_in_words(error, &PairNumbers)
}

/// Returns the message of an error, with names of pairs.
pub fn named_error_in_words(error: &EstimateError, names: &dyn PairNames) -> String {
    let more = match error {
        EstimateError::TooFewPairs { .. } => ". Mark more scene points in both images",
        EstimateError::TooClose { .. } => ". Choose points farther from each other",
        EstimateError::Flat(_) => ", so lines cannot be compared. Use an image with texture",
        EstimateError::Parameter { key, value, range: [least, most], unit } => {
            let (name, least, most) = (key.replace('_', " "), in_words(*least), in_words(*most));
            return format!("parameter {name} is {value}: it must be between {least} and {most}{unit}");
        }
        EstimateError::ManyChanges { .. } => {
            ", so the comparison of all lines would take minutes. Raise lambda or lower alpha"
        }
        EstimateError::NoParallax => {
            ", so there is no parallax and every geometry fits. Use images taken from different places"
        }
        EstimateError::NoCandidates(_) => ". Choose a point in a textured part of the images",
        EstimateError::NoGeometry => ". Check that the point pairs match, or choose other points",
        EstimateError::NothingWithoutClicks => ". Mark two scene points in both images and try again",
        EstimateError::Given(_) => {
            ". Give more matches, or leave out given_alone, so that the program adds its own"
        }
        EstimateError::NoSequences => ". Open sequences, or compare lines by stereo",
        EstimateError::NothingFromBarcodes => {
            ", since too few lines have a distinctive motion. \
             Use longer recordings, or recordings with motion in more places"
        }
        EstimateError::NotFinite(_)
        | EstimateError::TooSmall { .. }
        | EstimateError::Outside { .. }
        | EstimateError::Motion(_)
        | EstimateError::Cancelled => "",
    };
    format!("{}{more}", error.fact(names))
}

/// Returns a text with a capital first letter, as the beginning of a sentence.
pub fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or(String::new(), |first| first.to_uppercase().chain(characters).collect())
}

/// Formats a number for sentences: with commas between thousands, and π by name.
fn in_words(value: f64) -> String {
    if value.to_bits() == PI.to_bits() {
        return "π".to_owned();
    }
    let plain = value.to_string();
    let digits = plain.find('.').unwrap_or(plain.len());
    let mut text = String::new();
    for (k, character) in plain.chars().enumerate() {
        if k > 0 && k < digits && (digits - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(character);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Parameters;

    #[test]
    fn numbers_are_formatted_for_sentences() {
        assert_eq!([0.005, 60.0, 1000.0, 1e6, PI].map(in_words), ["0.005", "60", "1,000", "1,000,000", "π"]);
    }

    #[test]
    fn messages_state_the_fact_and_then_the_action() {
        let mut parameters = Parameters::default();
        parameters.pencils.line_spacing = 100.0;
        let told = error_in_words(&parameters.check().unwrap_err());
        assert_eq!(told, "parameter line spacing is 100: it must be between 0.5 and 16 px");
        let told = error_in_words(&EstimateError::Flat(2));
        let expected =
            "the right image is (nearly) uniform, so lines cannot be compared. Use an image with texture";
        assert_eq!(told, expected);
    }
}
