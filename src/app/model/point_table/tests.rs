use super::pasting::parse_table;
use super::*;
use crate::app::model::document::{Document, PictureIdentity};
use crate::estimate::Parameters;
use crate::geometry::Frame;

fn model(pairs: &[PointPair]) -> Model {
    let picture = |name: &str| PictureIdentity { name: name.into(), path: None, frame: Frame::new(200, 100) };
    let mut document = Document::new([picture("a"), picture("b")], Parameters::default());
    document.set_pairs(pairs.to_vec(), PairOrigin::Clicked);
    Model { document, ..Model::default() }
}

#[test]
fn tables_are_read_with_headings_commas_and_names() {
    let pair = PointPair::new(1.5, 2.0, -3.0, 4.25);
    for text in [
        "1.5 2 -3 4.25",
        "x1,y1,x2,y2\n1.5,2,-3,4.25\n",
        "\"x1\";\"y1\";\"x2\";\"y2\"\r\n1,5;2;-3;4,25\r\n",
        "# a comment\n\n1,5\t2\t-3\t4,25\tclicked",
        "\t1.5\t2\t-3\t4.25",
        "x1 y1 x2 y2 distance\n1.5 2 -3 4.25 0.7",
    ] {
        assert_eq!(parse_table(text), Ok(vec![(None, pair)]), "{text:?}");
    }
    for text in ["door 1.5 2 -3 4.25", "Name,x1,y1,x2,y2,role\ndoor,1.5,2,-3,4.25,used"] {
        assert_eq!(parse_table(text), Ok(vec![(Some("door".to_owned()), pair)]), "{text:?}");
    }
    for text in ["", "hello", "1 2 3", "1 2 3 4\nx y z w", "1 2 3 inf"] {
        assert!(parse_table(text).is_err(), "{text:?}");
    }
    assert!(parse_table("1 2 3 4\n1 2 3\n").unwrap_err().contains("line 2"));
}

#[test]
fn pasted_pairs_outside_the_images_are_left_out_with_a_message() {
    let mut model = model(&[]);
    model.paste_pairs("1 2 3 4\n900 2 3 4");
    assert_eq!(model.document.pairs, [PointPair::new(1.0, 2.0, 3.0, 4.0)]);
    assert!(model.messages.list()[0].text.starts_with("1 of the 2 pasted point pairs lies outside"));
    model.paste_pairs("no numbers here");
    assert_eq!(model.document.pairs.len(), 1);
}
