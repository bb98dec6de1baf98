use super::*;
use crate::estimate::Preset;

fn document() -> Document {
    let picture = |name: &str| PictureIdentity { name: name.into(), path: None, frame: Frame::new(100, 80) };
    Document::new([picture("a"), picture("b")], Parameters::default())
}

#[test]
fn two_clicks_in_either_order_make_a_pair() {
    let mut document = document();
    document.place(Side::Left, Point::new(1.0, 2.0));
    assert!(document.half.is_some() && document.pairs.is_empty());
    document.place(Side::Right, Point::new(3.0, 4.0));
    document.place(Side::Right, Point::new(7.0, 8.0));
    document.place(Side::Left, Point::new(5.0, 6.0));
    assert_eq!(document.pairs, [PointPair::new(1.0, 2.0, 3.0, 4.0), PointPair::new(5.0, 6.0, 7.0, 8.0)]);
    assert!(document.half.is_none());
    assert_eq!(document.used_pairs().map(|pairs| pairs.len()), Some(2));
}

#[test]
fn a_second_click_in_the_same_image_replaces_the_first() {
    let mut document = document();
    document.place(Side::Left, Point::new(1.0, 2.0));
    document.place(Side::Left, Point::new(9.0, 9.0));
    assert_eq!(document.half.map(|half| half.point), Some(Point::new(9.0, 9.0)));
    assert_eq!(document.points(Side::Left).count(), 1);
    assert_eq!(document.points(Side::Right).count(), 0);
}

#[test]
fn moving_or_removing_a_missing_point_changes_nothing() {
    let mut document = document();
    document.place(Side::Left, Point::new(1.0, 2.0));
    let before = document.clone();
    document.move_to(PointRef { pair: 0, side: Side::Right }, Point::new(5.0, 5.0));
    document.move_to(PointRef { pair: 7, side: Side::Right }, Point::new(5.0, 5.0));
    assert_eq!(document, before);
    document.remove(7);
    assert!(document.half.is_some());
    document.remove(0);
    assert!(document.half.is_none());
}

#[test]
fn all_pairs_but_checks_are_used_and_the_published_search_limits_their_number() {
    let mut document = document();
    document.set_pairs(vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 5], PairOrigin::Clicked);
    assert_eq!(document.used_pairs().map(|pairs| pairs.len()), Some(5));
    document.set_role(1, Role::Check);
    document.set_role(3, Role::Excluded);
    assert_eq!(document.used().collect::<Vec<_>>(), [0, 2, 4]);
    assert_eq!((document.role(1), document.role(3)), (Role::Check, Role::Excluded));
    document.remove(0);
    assert_eq!(document.used().collect::<Vec<_>>(), [1, 3], "numbers follow when an earlier pair is removed");
    document.set_role(2, Role::Used);
    document.set_role(0, Role::Used);
    assert_eq!(document.used().count(), 4);
    document.parameters = Parameters::from(Preset::Paper);
    assert_eq!((document.used().count(), document.role(2)), (2, Role::Check));
    document.parameters.method = Method::ThreePoint;
    assert_eq!((document.used().count(), document.role(2)), (3, Role::Used));
}

#[test]
fn an_excluded_pair_makes_room_for_the_next_one_in_the_published_search() {
    let mut document = document();
    document.parameters = Parameters::from(Preset::Paper);
    let pair = |x: f64| PointPair::new(x, 1.0, x, 1.0);
    document.set_pairs([1.0, 2.0, 3.0, 4.0].map(pair).to_vec(), PairOrigin::Clicked);
    document.set_role(1, Role::Excluded);
    assert_eq!(document.used_pairs(), Some(vec![pair(1.0), pair(3.0)]));
    let roles: Vec<_> = (0..4).map(|k| document.role(k)).collect();
    assert_eq!(roles, [Role::Used, Role::Excluded, Role::Used, Role::Check]);
    document.remove(0);
    assert_eq!(document.role(0), Role::Excluded, "numbers follow when an earlier pair is removed");
    document.set_role(0, Role::Used);
    assert_eq!(document.used_pairs(), Some(vec![pair(2.0), pair(3.0)]));
    document.set_role(1, Role::Excluded);
    document.set_role(2, Role::Excluded);
    assert_eq!(document.used_pairs(), None);
}

#[test]
fn notes_follow_their_pairs_and_a_moved_point_is_clicked_again() {
    let mut document = document();
    let pair = |x: f64| PointPair::new(x, 1.0, x, 1.0);
    document.set_pairs([1.0, 2.0, 3.0].map(pair).to_vec(), PairOrigin::Imported);
    document.rename(2, "door");
    document.rename(1, "q");
    assert_eq!((document.given_name(1), document.name(2).as_str()), (None, "door"));
    document.remove(0);
    assert_eq!((document.name(0).as_str(), document.name(1).as_str()), ("p", "door"));
    document.move_to(PointRef { pair: 1, side: Side::Left }, Point::new(9.0, 9.0));
    assert_eq!(document.origin(1), PairOrigin::Clicked);
    assert_eq!(document.origin(0), PairOrigin::Imported);
    document.place(Side::Left, Point::new(5.0, 5.0));
    document.accept(Side::Right, Point::new(6.0, 5.0));
    assert_eq!(document.origin(2), PairOrigin::Suggested);
    let text = serde_json::to_string(&document).unwrap();
    let back: Document = serde_json::from_str(&text).unwrap();
    assert_eq!((back.name(1), back.origin(2)), (document.name(1), PairOrigin::Suggested));
    document.remove_all([0, 2]);
    assert_eq!((document.pairs.len(), document.name(0).as_str()), (1, "door"));
}

#[test]
fn pencils_have_the_name_of_the_pair_that_they_pass_through() {
    let mut document = document();
    let pairs = [[1.0, 2.0], [2.0, 2.0], [50.0, 60.0]].map(|[x, y]| PointPair::new(x, y, x, y));
    document.set_pairs(pairs.to_vec(), PairOrigin::Clicked);
    assert_eq!(document.pair_of_pencils(1, &pairs[2]), Some(2), "the farther one was taken");
    let before_the_drag = PointPair::new(3.0, 3.0, 3.0, 3.0);
    assert_eq!(document.pair_of_pencils(1, &before_the_drag), Some(1));
    document.set_pairs(pairs[..1].to_vec(), PairOrigin::Clicked);
    document.unclicked = true;
    assert_eq!(document.pair_of_pencils(1, &before_the_drag), None, "a match replaces the click");
}
