use super::pasting::parse_table;
use super::*;
use crate::app::model::document::{Document, PictureIdentity};
use crate::estimate::Parameters;
use crate::geometry::Frame;
use std::collections::BTreeSet;

fn model(pairs: &[PointPair]) -> Model {
    let picture = |name: &str| PictureIdentity { name: name.into(), path: None, frame: Frame::new(200, 100) };
    let mut document = Document::new([picture("a"), picture("b")], Parameters::default());
    document.set_pairs(pairs.to_vec(), PairOrigin::Clicked);
    Model { document, ..Model::default() }
}

fn five() -> Model {
    model(&[30.0, 10.0, 50.0, 20.0, 40.0].map(|x| PointPair::new(x, 5.0, 100.0 - x, 6.0)))
}

#[test]
fn rows_are_selected_alone_added_and_in_ranges() {
    let mut model = five();
    model.choose_pair(4, Choosing::Only);
    model.choose_pair(2, Choosing::Through);
    assert_eq!(model.document.chosen, BTreeSet::from([2, 3, 4]));
    model.choose_pair(3, Choosing::Toggle);
    model.choose_pair(1, Choosing::Toggle);
    assert_eq!(model.document.chosen, BTreeSet::from([1, 2, 4]));
    model.choose_pair(2, Choosing::Only);
    assert_eq!(model.document.chosen, BTreeSet::from([2]));
    model.choose_pair(2, Choosing::Only);
    assert!(model.document.chosen.is_empty(), "a second click deselects");
}

#[test]
fn selected_pairs_are_edited_in_one_step() {
    let mut model = five();
    model.document.chosen = BTreeSet::from([1, 3]);
    model.edit_chosen(ChosenEdit::CheckOnly);
    assert_eq!(model.document.used().collect::<Vec<_>>(), [0, 2, 4]);
    model.edit_chosen(ChosenEdit::Delete);
    assert_eq!(model.document.pairs.iter().map(|p| p.point1.x).collect::<Vec<_>>(), [30.0, 50.0, 40.0]);
    model.travel(true);
    assert_eq!((model.document.pairs.len(), model.document.used().count()), (5, 3));
    model.travel(true);
    assert_eq!(model.document.used().count(), 5);
}

#[test]
fn copied_pairs_can_be_pasted() {
    let mut source = five();
    source.document.rename(2, "left eye");
    source.document.chosen = BTreeSet::from([0, 2]);
    let text = source.copied_pairs();
    assert_eq!(text, "name\tx1\ty1\tx2\ty2\np\t30\t5\t70\t6\nleft eye\t50\t5\t50\t6\n");
    let mut target = model(&[PointPair::new(1.0, 2.0, 3.0, 4.0)]);
    target.paste_pairs(&text);
    assert_eq!(target.document.pairs[1..], [source.document.pairs[0], source.document.pairs[2]]);
    assert_eq!((target.document.given_name(1), target.document.name(2).as_str()), (None, "left eye"));
    assert_eq!(target.document.origin(2), PairOrigin::Pasted);
    assert_eq!(target.document.chosen, BTreeSet::from([1, 2]));
    target.travel(true);
    assert_eq!(target.document.pairs.len(), 1);
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
