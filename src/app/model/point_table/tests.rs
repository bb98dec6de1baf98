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
fn pasted_pairs_outside_the_images_are_left_out_with_a_message() {
    let mut model = model(&[]);
    model.paste_pairs("1 2 3 4\n900 2 3 4");
    assert_eq!(model.document.pairs, [PointPair::new(1.0, 2.0, 3.0, 4.0)]);
    assert!(model.messages.list()[0].text.starts_with("1 of the 2 pasted point pairs lies outside"));
    model.paste_pairs("no numbers here");
    assert_eq!(model.document.pairs.len(), 1);
}
