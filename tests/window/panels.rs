//! The panels around the images: what they show, and what follows in the rest of the window.

use crate::support::*;

use egui::accesskit::Role;
use egui::{Color32, Key, Modifiers, Shape, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use epiline::estimate::{
    Apart, Assessment, Determined, Estimate, EstimateError, Match, Parameters, Reason, RefinedMatch, Search,
    Trust, Verdict, estimate_points,
};
use epiline::geometry::{Frame, Point, PointPair};
use epiline::internals::app::model::comparison::PointSet;
use epiline::internals::app::model::dock::DockEdge;
use epiline::internals::app::model::document::LineSource;
use epiline::internals::app::model::document::{Role as PairRole, Side};
use epiline::internals::app::model::focus::Target;
use epiline::internals::app::{Services, Start};
use epiline::study::PlaceFound;

/// The sample with two pairs and a result with hypotheses and pencils.
fn with_result() -> Window {
    let mut window = window(Start::default(), rich_services());
    click_two_pairs(&mut window);
    window
}

#[test]
fn choosing_a_hypothesis_changes_the_lines_until_the_result_is_wanted_again() {
    let mut window = with_result();
    show_hypotheses(&mut window);
    let estimate = window.state().estimate().unwrap().clone();
    let third = &estimate.hypotheses()[2].fundamental();
    assert!(
        shows_lines(&window, estimate.fundamental(), ESTIMATED) && !shows_lines(&window, third, ESTIMATED)
    );
    tap(&mut window, "Hypothesis 3");
    assert_eq!(window.state().focus().hypothesis(), Some(2));
    // A wrong hypothesis never has the green of a reliable result.
    assert!(shows_lines(&window, third, OTHER) && lines(&window, Side::Right, ESTIMATED).is_empty());
    window.get_by_label_contains("The images show hypothesis 3, not the result");
    let named = format!("hypothesis 3 of {}, not the result", estimate.hypotheses().len());
    for notation in ["JSON", "NumPy", "MATLAB", "LaTeX"] {
        let text = crate::clipboard::copied(&mut window, &format!("Copy F as {notation}")).unwrap();
        assert!(text.contains(&named), "{text}");
    }
    settle(&mut window);
    press(&mut window, Key::R);
    assert!(shows_lines(&window, estimate.fundamental(), ESTIMATED));
    // A new result has other hypotheses.
    tap(&mut window, "Hypothesis 2");
    let moved = screen(&window, P_LEFT) + vec2(20.0, 0.0);
    let from = screen(&window, P_LEFT);
    drag(&mut window, from, moved, egui::PointerButton::Primary);
    assert_eq!(window.state().focus().hypothesis(), None);
}

#[test]
fn the_matches_of_the_result_are_pale_under_another_geometry() {
    let services = Services {
        estimate: Box::new(|request, _| matched_estimate(&request.pairs, &request.parameters)),
        ..services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    choose(&mut window, "Overlays", "Show Matches");
    press(&mut window, Key::Escape);
    let match_color = Color32::from_rgb(184, 113, 242);
    let dots = |window: &Window, color: Color32| {
        let is_dot = |shape: &Shape| matches!(shape, Shape::Circle(circle) if circle.fill == color);
        window.output().shapes.iter().filter(|clipped| is_dot(&clipped.shape)).count()
    };
    assert_eq!(dots(&window, match_color), 6);
    show_hypotheses(&mut window);
    tap(&mut window, "Hypothesis 3");
    window.get_by_label_contains("The pale dots are the matches of the result");
    assert_eq!((dots(&window, match_color), dots(&window, match_color.gamma_multiply(0.45))), (0, 6));
}

#[test]
fn a_comparison_starts_on_the_matches_and_says_that_it_is_partly_circular() {
    let services = Services {
        estimate: Box::new(|request, _| matched_estimate(&request.pairs, &request.parameters)),
        ..services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    press(&mut window, Key::Num4);
    let measured = window.state().model().open.comparison.as_ref().unwrap().measured;
    assert_eq!(measured, PointSet::Matches);
    window.get_by_label_contains("partly circular");
    // In a narrow dock, the tools have a line of their own.
    run_command(&mut window, "Dock: at the right");
    window.set_size(vec2(1024.0, 640.0));
    settle(&mut window);
    let [tab, tool] = ["Compare", "Ground truth"].map(|name| {
        window.query_all_by_label(name).map(|node| node.rect()).min_by(|a, b| a.min.y.total_cmp(&b.min.y))
    });
    let (tab, tool) = (tab.unwrap(), tool.unwrap());
    assert!(!tab.intersects(tool) && tool.max.x <= 1024.0, "{tab:?} {tool:?}");
}

#[test]
fn a_new_pair_is_told_its_distance_from_the_result_before() {
    let mut window = with_result();
    for side in Side::BOTH {
        click_at(&mut window, side, 0.1, -0.3);
    }
    window.get_by_label_contains("px from the lines of the previous result");
}

#[test]
fn the_hypotheses_can_be_sorted_both_ways() {
    let mut window = with_result();
    show_hypotheses(&mut window);
    let order = |window: &Window| {
        let mut rows: Vec<_> =
            (1..=3).map(|k| (window.get_by_label(&format!("Hypothesis {k}")).rect().min.y, k)).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        rows.into_iter().map(|(_, k)| k).collect::<Vec<_>>()
    };
    assert_eq!(order(&window), [1, 2, 3]);
    tap(&mut window, "Sort by Line cost");
    assert_eq!(order(&window), [3, 2, 1], "the lowest cost first");
    tap(&mut window, "Sort by Line cost");
    assert_eq!(order(&window), [1, 2, 3]);
}

#[test]
fn a_row_under_the_cursor_is_told_to_the_rest_of_the_window() {
    let mut window = with_result();
    show_hypotheses(&mut window);
    let row = window.get_by_label("Hypothesis 2").rect().center();
    window.hover_at(row);
    settle(&mut window);
    assert_eq!(window.state().focus().hovered(), Some(Target::Hypothesis(1)));
    let image = at(&window, Side::Left, 0.0, 0.0);
    window.hover_at(image);
    settle(&mut window);
    assert_eq!(window.state().focus().hovered(), None);
}

#[test]
fn a_cell_of_the_pencils_is_pointed_at_and_a_click_inspects_its_lines() {
    let mut window = with_result();
    show_step(&mut window, "Pencils");
    // Two matrices: p and q.
    window.get_by_label("pencil matrix of q");
    let matrix = window.get_by_label("pencil matrix of p").rect();
    let lit =
        |window: &Window| Side::BOTH.map(|side| lines(window, side, Color32::from_rgb(244, 239, 110)).len());
    let before = lit(&window);
    // The middle of the matrix: a right angle, unturned. It is a candidate.
    window.hover_at(matrix.center() + vec2(2.0, 2.0));
    settle(&mut window);
    let hovered = window.state().focus().hovered();
    let Some(Target::Cell { pair: 0, row, column }) = hovered else { panic!("{hovered:?}") };
    let estimate = window.state().estimate().unwrap();
    let angles = estimate.trace.as_ref().unwrap().pencils[0].angles(row, column).unwrap();
    let right_angle = std::f64::consts::FRAC_PI_2;
    assert!(angles.iter().all(|angle| (angle - right_angle).abs() < 1e-9), "{angles:?}");
    assert!(lit(&window).iter().zip(before).all(|(now, before)| *now > before), "lines in both images");
    click(&mut window, matrix.center() + vec2(2.0, 2.0));
    let pin = *window.state().document().inspected_pin().expect("a pinned pair");
    assert_eq!(pin.source, LineSource::Pencil { pair: 0, angles });
    window.hover_at(egui::pos2(4.0, 844.0));
    press(&mut window, Key::Num2);
    window.get_by_label_contains("Lines through p at 90.0° and 90.0°, ");
    // Another one; the first is chosen again by its colour, and taken away.
    window.get_by_label("Row of pair q").click_secondary();
    settle(&mut window);
    tap(&mut window, "Pin lines");
    window.get_by_label_contains("Inspect: Epipolar lines of q");
    window.get_by_label_contains("Inspect: Lines through p at 90.0° and 90.0°").click();
    settle(&mut window);
    assert_eq!(window.state().document().inspected_pin(), Some(&pin));
    tap(&mut window, "Unpin");
    assert_eq!(window.state().document().inspected_pin().map(|pin| pin.source), Some(LineSource::Pair(1)));
    tap(&mut window, "Unpin");
    assert!(window.state().document().pins.is_empty());
    window.hover_at(egui::pos2(4.0, 844.0));
    settle(&mut window);
    // The profiles follow the selected pair, and the left line runs to the right.
    for name in ["p", "q"] {
        tap(&mut window, &format!("Row of pair {name}"));
        window.get_by_label_contains(&format!("Lines of {name}, "));
        let inspection = window.state().model().open.inspection.as_ref().unwrap();
        assert!(inspection.lines[0].direction.x > 0.0);
    }
}

#[test]
fn a_place_in_the_profiles_is_a_sample_of_the_line() {
    let mut window = with_result();
    press(&mut window, Key::Num2);
    let title = window.get_by_label("Grey before warping").rect();
    window.hover_at(title.left_bottom() + vec2(150.0, 20.0));
    settle(&mut window);
    let hovered = window.state().focus().hovered();
    assert!(matches!(hovered, Some(Target::Sample(_))), "{hovered:?}");
    window.get_by_label_contains("px: grey ");
}

#[test]
fn a_parameter_recomputes_and_undo_takes_it_back() {
    let mut window = with_result();
    let before = window.state().document().parameters.clone();
    window.set_size(vec2(1800.0, 1300.0));
    show_parameters(&mut window, "Epipoles");
    window.get_by_role_and_label(Role::CheckBox, "Patch support").click();
    settle(&mut window);
    assert_eq!(before.search, Search::Patches);
    let expected = Parameters { search: Search::Lines, ..before.clone() };
    assert_eq!(window.state().document().parameters, expected);
    // There and back again with the same switch are two steps.
    for wanted in [&before, &expected] {
        window.get_by_role_and_label(Role::CheckBox, "Patch support").click();
        settle(&mut window);
        assert_eq!(window.state().document().parameters, *wanted);
    }
    tap(&mut window, "Reset Patch support");
    assert_eq!(window.state().document().parameters, before);
    for parameters in [&expected, &before, &expected, &before] {
        undo(&mut window);
        assert_eq!(window.state().document().parameters, *parameters);
    }
    assert_eq!(window.state().document().pairs.len(), 2, "the points are no part of it");
}

#[test]
fn a_parameter_out_of_range_is_told_with_its_range_and_reset_with_all_others() {
    let mut window = with_result();
    window.set_size(vec2(1800.0, 1300.0));
    show_parameters(&mut window, "Pencils");
    window.get_by_role_and_label(Role::SpinButton, "Line spacing").click();
    settle(&mut window);
    window.event(egui::Event::Text("99".into()));
    settle(&mut window);
    press(&mut window, Key::Enter);
    assert!((window.state().document().parameters.pencils.line_spacing - 99.0).abs() < 1e-9);
    window.get_by_label("Line spacing must be between 0.5 and 16 px.");
    tap(&mut window, "Reset all");
    assert_eq!(window.state().document().parameters, Parameters::default());
    assert!(window.query_by_label_contains("must be between").is_none());
}

#[test]
fn a_pair_left_out_takes_no_part_in_the_estimate() {
    let mut window = with_result();
    for side in Side::BOTH {
        click_at(&mut window, side, 0.1, -0.3);
    }
    let third = window.state().document().pairs[2];
    unfold(&mut window, "p");
    tap(&mut window, "Leave out pair p");
    let used = window.state().document().used_pairs().unwrap();
    assert_eq!(used[1], third);
    window.get_by_label_contains("Found from q and r");
    undo(&mut window);
    window.get_by_label_contains("Found from p, q and r");
    unfold(&mut window, "r");
    tap(&mut window, "Check only pair r");
    window.get_by_label_contains("Check pairs");
}

#[test]
fn the_start_shows_one_card_and_every_tab_says_what_will_appear() {
    let mut window = window(Start::default(), rich_services());
    window.get_by_label("Show me how the lines are found");
    assert_eq!(window.state().model().doubt(), None, "without a geometry there is nothing to doubt");
    assert!(window.query_by_label("Profiles").is_none() && window.query_by_label("Point pairs").is_none());
    assert!(window.get_by_label("Rectified").accesskit_node().is_disabled(), "there is nothing to rectify");
    click_at(&mut window, Side::Left, 0.1, 0.1);
    window.get_by_label_contains("Click the same scene point in the other image");
    for (key, says) in [
        (Key::Num1, "Candidate geometries appear here"),
        (Key::Num2, "Intensities along a line pair"),
        (Key::Num3, "Distances from the epipolar lines appear here"),
        (Key::Num4, "Distances from the epipolar lines appear here"),
    ] {
        press(&mut window, key);
        window.get_by_label_contains(says);
    }
}

#[test]
fn the_dock_folds_to_a_line_with_the_verdict_and_the_pictures_can_stand_alone() {
    let mut window = with_result();
    let height = |window: &Window| pane(window, Side::Left).height();
    let before = height(&window);
    press(&mut window, Key::B);
    assert!(height(&window) > before + 100.0);
    window.get_by_label("Estimated");
    tap(&mut window, "Show dock");
    assert!((height(&window) - before).abs() < 1.0);
    press(&mut window, Key::H);
    assert!(window.query_by_label("Open").is_none() && window.query_by_label("Estimated").is_none());
    press(&mut window, Key::Escape);
    window.get_by_label("Open");
    assert!((height(&window) - before).abs() < 1.0);
}

#[test]
fn the_steps_are_followed_by_one_key_and_draw_over_the_pictures() {
    let mut window = with_result();
    let round_trip = Color32::from_rgb(143, 180, 255);
    let drawn = |window: &Window| lines(window, Side::Right, round_trip).len();
    for (step, says) in [
        ("Pencils", "A line turns about a clicked point on the left."),
        (
            "Candidates",
            "Candidates are line pairs of which each line is among the best partners of the other.",
        ),
        ("Features", "Distinctive places are matched by their surroundings"),
        ("Epipoles", "A candidate of p and one of q cross."),
    ] {
        press(&mut window, Key::N);
        assert_eq!(window.state().model().replayed().unwrap().step.title(), step);
        window.get_by_label_contains(says);
        assert_eq!(drawn(&window), 0, "{step}");
    }
    press(&mut window, Key::N);
    window.get_by_label_contains("G takes that back to G H l.");
    assert_eq!(drawn(&window), 1, "H l");
    press(&mut window, Key::N);
    assert_eq!(drawn(&window), 0, "with its step the drawing goes");
    press_with(&mut window, Modifiers::SHIFT, Key::N);
    assert_eq!(drawn(&window), 1);
    press(&mut window, Key::End);
    assert_eq!((drawn(&window), window.state().model().replayed()), (0, None));
}

#[test]
fn the_button_of_the_card_does_what_its_sentence_asks_for() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        let reasons = vec![click_off(2, 40.0)];
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        Ok(estimate)
    });
    let matched = Point::new(333.0, 222.0);
    find_matches_at(&mut services, Some(matched));
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window.get_by_label_contains("Point pair q is ");
    tap(&mut window, "Move q to its match");
    assert_eq!(window.state().document().pairs[1].point2, matched);
}

#[test]
fn a_pair_without_a_clear_match_can_only_be_left_out() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
        let reasons = vec![click_off(2, 40.0)];
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Doubtful, reasons });
        Ok(estimate)
    });
    find_matches_at(&mut services, None);
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    assert!(window.get_by_label("Move q to its match").accesskit_node().is_disabled());
    tap(&mut window, "Leave out q");
    assert_eq!(window.state().document().role(1), PairRole::Excluded);
    assert!(window.query_by_label("Move q to its match").is_none());
}

/// Finds the matches of all pairs at one place.
fn find_matches_at(services: &mut Services, place: Option<Point>) {
    services.places = Box::new(move |question| {
        question.pairs.iter().map(|pair| PlaceFound { pair: *pair, place, is_confirmed: false }).collect()
    });
}

#[test]
fn the_window_tells_whether_the_pair_is_rectified() {
    let mut window = sample();
    run_command(&mut window, "Is the pair rectified?");
    window.get_by_label_contains("There are too few matches to compare rows");
    // Rows that differ by 1 px, and by 100 px.
    for (offset, says) in [(1.0, "are not rectified: rows differ by 1.00 px"), (100.0, "rows differ by 100")]
    {
        let mut services = services();
        services.estimate = Box::new(move |request, _| {
            let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
            let at = |k: usize| ((k * 37 % 700) as f64, (k * 53 % 400) as f64);
            let pair = |(x, y): (f64, f64)| PointPair::new(x, y, x + 9.0, y + offset);
            let found = (0..60).map(|k| RefinedMatch { pair: pair(at(k)), correlation: 1.0 });
            estimate.assessment.distinctive = (0..60).map(|k| pair(at(k))).collect();
            estimate.assessment.refinement.as_mut().unwrap().matches = found.collect();
            Ok(estimate)
        });
        let mut window = self::window(Start::default(), services);
        click_two_pairs(&mut window);
        run_command(&mut window, "Is the pair rectified?");
        window.get_by_label_contains(says);
    }
}

#[test]
fn lines_look_like_the_verdict() {
    let judged = |verdict: Verdict| {
        let mut services = services();
        services.estimate = Box::new(move |request, _| {
            let mut estimate = fake_estimate(&request.pairs, &request.parameters)?;
            let reasons = match verdict {
                Verdict::Reliable => Vec::new(),
                _ => vec![click_off(2, 40.0)],
            };
            estimate.assessment.trust = Some(Trust { verdict, reasons });
            Ok(estimate)
        });
        let mut window = window(Start::default(), services);
        click_two_pairs(&mut window);
        window
    };
    let amber = Color32::from_rgb(240, 163, 32);
    let count = |window: &Window, color| lines(window, Side::Right, color).len();
    let reliable = judged(Verdict::Reliable);
    reliable.get_by_label("Reliable");
    reliable.get_by_label("97 % likely within 8 px near the matches");
    assert!(count(&reliable, ESTIMATED) >= 9 && count(&reliable, amber) == 0);
    let doubtful = judged(Verdict::Doubtful);
    doubtful.get_by_label("Doubtful");
    assert_eq!(count(&doubtful, ESTIMATED), 0);
    assert!(count(&doubtful, amber) > 20, "dashes");
    let red = Color32::from_rgb(240, 101, 91);
    let dots = |window: &Window| {
        let is_dot = |shape: &Shape| matches!(shape, Shape::Circle(circle) if circle.fill == red);
        window.output().shapes.iter().filter(|clipped| is_dot(&clipped.shape)).count()
    };
    let mut unreliable = judged(Verdict::Unreliable);
    unreliable.get_by_label("Unreliable");
    assert_eq!(count(&unreliable, ESTIMATED) + count(&unreliable, amber) + dots(&unreliable), 0);
    tap(&mut unreliable, "Show lines anyway");
    assert!(dots(&unreliable) > 20);
    // The wish belongs to this result, not to the next one.
    press(&mut unreliable, Key::ArrowRight);
    unreliable.get_by_label("Unreliable");
    assert_eq!(dots(&unreliable), 0);
}

#[test]
fn pictures_of_different_scenes_have_no_lines_and_no_export() {
    let services = Services {
        estimate: Box::new(|request, _| {
            let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
            let reasons = vec![Reason::DifferentScenes { agreeing: 5, by_chance: 14, matches: 62 }];
            estimate.assessment.trust = Some(Trust { verdict: Verdict::DifferentScenes, reasons });
            Ok(estimate)
        }),
        ..rich_services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window.get_by_label("Different scenes?");
    for color in [ESTIMATED, Color32::from_rgb(240, 163, 32), Color32::from_rgb(240, 101, 91)] {
        assert!(lines(&window, Side::Right, color).is_empty());
    }
    assert!(window.query_by_label("Show lines anyway").is_none());
    press(&mut window, Key::Num1);
    assert!(painted(&window, "agree by chance") && painted(&window, "agree here"));
    assert!(window.get_by_label("Rectified").accesskit_node().is_disabled());
    press_with(&mut window, Modifiers::COMMAND, Key::E);
    window.get_by_label_contains("so there is no geometry to write");
    press(&mut window, Key::Escape);
    tap(&mut window, "Click pairs anyway");
    assert!(window.state().document().pairs.is_empty() && window.state().estimate().is_none());
}

#[test]
fn a_reliable_result_says_where_its_lines_are_open() {
    // Noise of ½ px on matches in one part of the images, from a camera that mostly goes forwards.
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let matches: Vec<Match> = (0..60)
        .map(|_| {
            let mut noise = || 0.5 * ((0..12).map(|_| random()).sum::<f64>() - 6.0);
            let [dx1, dy1, dx2, dy2] = [(); 4].map(|()| noise());
            let (x, y, depth) = (150.0 * random() - 284.0, 150.0 * random() - 238.0, 3.0 + 17.0 * random());
            let (x2, y2) = ((x * depth + 60.0) / (depth + 1.0), (y * depth + 6.0) / (depth + 1.0));
            PointPair::new(x + 384.0 + dx1, y + 288.0 + dy1, x2 + 384.0 + dx2, y2 + 288.0 + dy2).into()
        })
        .collect();
    let services = Services {
        estimate: Box::new(move |request, _| {
            let frames = [Frame { width: 768, height: 576 }; 2];
            let found =
                estimate_points(&matches, Some(frames), None, 0).map_err(|_| EstimateError::NoGeometry)?;
            let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
            estimate.fundamental = found.estimate.fundamental;
            estimate.assessment.refinement = found.estimate.assessment.refinement;
            estimate.assessment.trust = Some(Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
            assert_eq!(estimate.determined(frames), Some(Determined::NearMatches));
            Ok(estimate)
        }),
        ..rich_services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    window.get_by_label("Partly reliable");
    window.get_by_label_contains("Epipolar lines are right near the matches, and uncertain elsewhere.");
    let files = Files::new();
    let path = files.0.path().join("geometry.json");
    crate::exchange::export(&mut window, &["Geometry"], &path);
    assert!(std::fs::read_to_string(&path).unwrap().contains("partly reliable"));
    assert!(window.query_by_label_contains("% likely within").is_none());
}

#[test]
fn the_rival_that_makes_the_margin_is_marked() {
    let mut services = services();
    services.estimate = Box::new(|request, _| {
        let mut estimate = rich_estimate(&request.pairs, &request.parameters)?;
        // 100 of support against 80.
        estimate.assessment.margin = Some(0.2);
        estimate.assessment.apart =
            Some(Apart { distances: vec![0.4, 3.1, 25.0], limit: 3.84, matches: 221 });
        estimate.assessment.trust = Some(Trust { verdict: Verdict::Reliable, reasons: Vec::new() });
        Ok(estimate)
    });
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    tap(&mut window, "Details");
    window.get_by_label("20 %");
    show_hypotheses(&mut window);
    window.get_by_label("Hypothesis 3, the rival");
    assert_eq!(window.query_all_by_label_contains("Hypothesis 3, the rival").count(), 1);
    // The margin can be followed from the rows.
    for (row, says) in [
        (
            "Hypothesis 2",
            "Too near to the result to be a rival: half of the matches lie within 3.1 px of its lines. Its \
             epipole may differ.",
        ),
        (
            "Hypothesis 3, the rival",
            "The best clearly different geometry: half of the matches lie within 25.0 px of its lines. The \
             result leads by 20 %.",
        ),
    ] {
        let row = window.get_by_label(row).rect();
        // Beside the bars, which have their own words.
        window.hover_at(row.left_center() + vec2(30.0, 0.0));
        for _ in 0..30 {
            window.step();
        }
        window.get_by_label(says);
    }
}

#[test]
fn a_pair_unfolds_to_all_its_actions_and_nothing_is_cut() {
    let mut window = with_result();
    for (width, height) in [(1440.0, 900.0), (1024.0, 640.0)] {
        window.set_size(vec2(width, height));
        settle(&mut window);
        if window.query_by_label("Delete: pair p").is_none() {
            unfold(&mut window, "p");
        }
        let bottom = height - 24.0;
        for name in
            ["Left x of pair p", "Right y of pair p", "Name of pair p", "Leave out pair p", "Delete: pair p"]
        {
            let rect = window.get_by_label(name).rect();
            assert!(rect.max.x <= width && rect.min.x > 0.0, "{name} at {width}: {rect:?}");
            assert!(rect.max.y <= bottom, "{name} at {width}: {rect:?}");
        }
        let name = window.get_by_label("Name of pair p").rect().width();
        assert!(name >= 120.0, "{name} at {width}");
    }
    tap(&mut window, "Check only pair p");
    assert_eq!(window.state().document().checks.len(), 1);
    // The list scrolls to a selected pair far down.
    for k in 0..4 {
        for side in Side::BOTH {
            click_at(&mut window, side, 0.1 + 0.08 * k as f32, -0.3);
        }
    }
    let rect = window.get_by_label("Delete: pair 6").rect();
    let list = window.get_by_label("Row of pair 6").rect();
    assert!(rect.max.y <= 640.0 - 24.0 && list.min.y < rect.min.y, "{rect:?} {list:?}");
}

#[test]
fn coordinates_are_typed_checked_and_undone() {
    let mut window = with_result();
    let before = window.state().document().pairs[1];
    unfold(&mut window, "q");
    let typed = |window: &mut Window, name: &str, text: &str| {
        window.get_by_role_and_label(Role::SpinButton, name).click();
        settle(window);
        window.event(egui::Event::Text(text.into()));
        settle(window);
        press(window, Key::Enter);
        window.state().document().pairs[1]
    };
    let after = typed(&mut window, "Right x of pair q", "123.25");
    assert!((after.point2.x - 123.25).abs() < 1e-9 && (after.point2.y - before.point2.y).abs() < 1e-9);
    let selected = window.state().document().selection;
    assert_eq!(selected.map(|at| (at.pair, at.side)), Some((1, Side::Right)), "the arrow keys act on it");
    let f = *window.state().estimate().unwrap().fundamental();
    assert!(epiline::geometry::symmetric_epipolar_distance(&f, &after) < 1e-6, "it was computed anew");
    // Off the image it stays at the edge; what is no number changes nothing.
    assert!((typed(&mut window, "Left y of pair q", "99999").point1.y - 575.5).abs() < 1e-9);
    let kept = typed(&mut window, "Left x of pair q", "left");
    assert!((kept.point1.x - before.point1.x).abs() < 1e-9, "rounding is for the eye alone");
    for _ in 0..2 {
        undo(&mut window);
    }
    assert_eq!(window.state().document().pairs[1], before);
}

#[test]
fn a_small_window_has_all_its_tools() {
    let mut window = with_result();
    // 1024 x 640, and 1440 x 900 at twice the scale.
    for (width, height) in [(1024.0, 640.0), (720.0, 450.0)] {
        window.set_size(vec2(width, height));
        settle(&mut window);
        for name in [
            "Open",
            "Save",
            "Undo",
            "Pin tool",
            "Overlays",
            "Commands",
            "Export",
            "Help",
            "Rectified",
            "Profiles",
            "Compare",
            "Estimated",
        ]
        .into_iter()
        // In a narrow card the word needs the room. The list of commands copies F, too.
        .chain((width > 1000.0).then_some("Copy F as"))
        {
            let rect = window.get_by_label(name).rect();
            assert!(rect.min.x >= 0.0 && rect.max.x <= width, "{name} at {width}: {rect:?}");
            assert!(rect.max.y <= height, "{name} at {width}: {rect:?}");
        }
        choose(&mut window, "Overlays", "Link views");
        press(&mut window, Key::Escape);
    }
}

#[test]
fn the_key_sheet_is_grouped() {
    let mut window = sample();
    press(&mut window, Key::F1);
    for group in ["Mouse", "Points", "Files", "Display", "Panels", "Result", "Replay", "Program"] {
        assert!(window.query_all_by_label(group).count() >= 1, "{group}");
    }
    // Keys stand as they are printed on a keyboard, and the plain one before that with Shift.
    window.get_by_label(",");
    window.get_by_label(".");
    for [first, second] in [
        ["Undo the last step", "Redo the last undone step"],
        [
            "Save points, parameters, pinned lines and views in one JSON file",
            "Save the session in another file",
        ],
        ["Replay the next step alone", "Replay the previous step alone"],
    ] {
        let top = |label: &str| window.get_by_label(label).rect().min.y;
        assert!(top(first) < top(second), "{first}");
    }
}

#[test]
fn the_key_sheet_fits_a_laptop() {
    let mut window = sample();
    window.set_size(vec2(1440.0, 900.0));
    press(&mut window, Key::F1);
    let bottom = window.get_by_label_contains("Keys and mouse, Epiline ").rect().max.y + 760.0;
    for last in [
        "Write the geometry, the point pairs, the result, a profile or the view as a file for other programs",
        "Show both images redrawn with corresponding points in the same row",
        "Close the window",
    ] {
        let rect = window.get_by_label(last).rect();
        assert!(rect.max.y < bottom, "{last}: {rect:?}, {bottom}");
    }
}

#[test]
fn plots_that_have_no_room_are_scrolled_to() {
    let mut window = with_result();
    window.set_size(vec2(1024.0, 640.0));
    settle(&mut window);
    let place = |window: &Window, title: &str| window.get_by_label(title).rect();
    // The two curves come first, side by side; the others are below.
    let [before, after, costs] =
        ["Grey before warping", "Grey after warping", "Cost, grey²"].map(|title| place(&window, title));
    assert!((before.min.y - after.min.y).abs() < 1.0 && before.max.x < after.min.x, "{before:?} {after:?}");
    assert!(costs.min.y > before.min.y + 82.0, "no plot over another");
    press(&mut window, Key::Num3);
    assert!(window.get_by_label("Residuals of pair q").rect().max.x < 1024.0);
}

#[test]
fn nothing_is_cut_in_a_narrow_dock_and_plots_without_room_say_so() {
    let mut window = with_result();
    run_command(&mut window, "Dock: at the right");
    for step in ["Pencils", "Candidates", "Features", "Epipoles", "Round trip", "Validation", "Refinement"] {
        show_step(&mut window, step);
        assert_eq!(cut_texts(&window), [""; 0], "step {step}");
    }
    show_step(&mut window, "Pencils");
    assert!(!painted(&window, "Enlarge the dock"));
    // The row has both epipoles, and the table only one.
    show_hypotheses(&mut window);
    let row = window.get_by_label("Hypothesis 2").rect();
    window.hover_at(row.left_center() + vec2(30.0, 0.0));
    for _ in 0..30 {
        window.step();
    }
    assert!(painted(&window, "Right epipole, px: ") && !painted(&window, "Right epipole\n"));

    run_command(&mut window, "Dock: at the bottom");
    window.set_size(vec2(1024.0, 640.0));
    show_step(&mut window, "Pencils");
    let mut look = window.state().look().clone();
    look.dock.set_share(DockEdge::Bottom, Some(0.0));
    window.state_mut().set_look(look);
    window.ctx.set_zoom_factor(1.5);
    settle(&mut window);
    assert!(painted(&window, "Enlarge the dock to see the plots."));
}

/// Returns the texts in view that have no room: they end in "…", or at the edge of their area.
fn cut_texts(window: &Window) -> Vec<String> {
    let text = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
        egui::Shape::Text(text) if clipped.clip_rect.contains(text.pos) => {
            let end = text.pos.x + text.galley.rect.max.x;
            let is_cut = text.galley.elided || end > clipped.clip_rect.max.x + 1.0;
            is_cut.then(|| text.galley.text().to_owned())
        }
        _ => None,
    };
    window.output().shapes.iter().filter_map(text).collect()
}

#[test]
fn a_long_verdict_is_not_cut_in_a_small_window() {
    let services = Services {
        estimate: Box::new(|request, _| {
            let found = fake_estimate(&request.pairs, &request.parameters)?;
            let reason = Reason::OnePlane { percent: 77, groups: 25, agreeing: 19, is_still: false };
            let trust = Some(Trust { verdict: Verdict::Doubtful, reasons: vec![reason] });
            Ok(Estimate { assessment: Assessment { trust, ..found.assessment }, ..found })
        }),
        ..services()
    };
    let mut window = window(Start::default(), services);
    click_two_pairs(&mut window);
    for (width, height) in [(1024.0, 640.0), (1280.0, 800.0)] {
        window.set_size(vec2(width, height));
        settle(&mut window);
        assert!(painted(&window, "not determined"));
        assert_eq!(cut_texts(&window), [""; 0], "at {width}");
    }
}

#[test]
fn no_text_is_cut_in_a_small_window() {
    let mut window = window(Start::default(), rich_services());
    window.set_size(vec2(1024.0, 640.0));
    settle(&mut window);
    assert_eq!(cut_texts(&window), [""; 0], "at the start");
    click_at(&mut window, Side::Left, 0.1, 0.1);
    assert_eq!(cut_texts(&window), [""; 0], "after the first click");
    press(&mut window, Key::Escape);
    click_two_pairs(&mut window);
    for tab in [Key::Num1, Key::Num3, Key::Num4, Key::Num2] {
        press(&mut window, tab);
        assert_eq!(cut_texts(&window), [""; 0], "tab {tab:?}");
    }
    for step in ["Pencils", "Candidates", "Features", "Epipoles", "Round trip", "Validation", "Refinement"] {
        show_step(&mut window, step);
        assert_eq!(cut_texts(&window), [""; 0], "step {step}");
    }
}
