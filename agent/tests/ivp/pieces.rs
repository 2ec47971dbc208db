//! Functions in pieces, and branch and bound, against a search of the whole domain.

use agent::ivp::branch::{best, sum};
use agent::ivp::domain::{AXES_MAX, Axis, Domain, DomainError, Point};
use agent::ivp::piecewise::{Fit, Piece, Piecewise, PiecewiseError};
use game::stream::Stream;

fn axis(name: &str, low: f64, high: f64, points: usize) -> Axis {
    Axis { name: name.to_owned(), low, high, points }
}

/// A domain of two to four axes, of a few thousand points at most.
fn domain(stream: &mut Stream) -> Domain {
    let count = 2 + stream.below(3) as usize;
    let most = [0, 0, 40, 14, 8][count];
    let names = ["course", "speed", "depth", "time"];
    let axes = names[..count].iter().map(|name| axis(name, 0.0, 1.0, 1 + stream.below(most) as usize));
    Domain::new(axes.collect()).expect("a domain")
}

/// All points of a domain, in the order in which equals are told apart.
fn points(domain: &Domain) -> Vec<Point> {
    let last = domain.last();
    let mut points = vec![Point::default()];
    for a in 0..domain.axes().len() {
        let along = |point: Point| {
            (0..=last[a]).map(move |i| {
                let mut point = point;
                point[a] = i;
                point
            })
        };
        points = points.into_iter().flat_map(along).collect();
    }
    points
}

/// A tiling by random cuts, with random slopes: whole numbers half of the time, for ties.
fn tiling(stream: &mut Stream, domain: &Domain) -> Piecewise {
    let mut boxes = vec![(Point::default(), domain.last())];
    for _ in 0..stream.below(14) {
        let i = stream.below(boxes.len() as u64) as usize;
        let a = stream.below(domain.axes().len() as u64) as usize;
        let (low, high) = boxes[i];
        if low[a] < high[a] {
            let cut = low[a] + stream.below(u64::from(high[a] - low[a])) as u16;
            let (mut below, mut above) = (high, low);
            (below[a], above[a]) = (cut, cut + 1);
            boxes[i] = (low, below);
            boxes.push((above, high));
        }
    }
    let whole = stream.below(2) == 0;
    let mut number = |limit: f64| {
        let number = stream.between(-limit, limit);
        if whole { number.round() } else { number }
    };
    let pieces = boxes.into_iter().map(|(low, high)| {
        let mut slope = [0.0; AXES_MAX];
        slope[..domain.axes().len()].iter_mut().for_each(|slope| *slope = number(1.4));
        Piece { low, high, slope, at_zero: 50.0 + number(3.0) }
    });
    Piecewise::new(domain, pieces.collect()).expect("a tiling")
}

#[test]
fn branch_and_bound_finds_what_a_search_of_the_whole_domain_finds() {
    let mut cut_off = 0;
    for seed in 0..3_000 {
        let mut stream = Stream::new(seed, "ivp/branch");
        let domain = domain(&mut stream);
        let mut tilings: Vec<(f64, Piecewise)> = Vec::new();
        for _ in 0..1 + stream.below(4) {
            let weight = [0.0, 1.0, 1.0, 2.0, stream.between(0.1, 500.0)][stream.below(5) as usize];
            tilings.push((weight, tiling(&mut stream, &domain)));
        }
        let mut functions: Vec<(f64, &Piecewise)> = tilings.iter().map(|(weight, tiling)| (*weight, tiling)).collect();
        let mut want = (f64::NEG_INFINITY, Point::default());
        for at in points(&domain) {
            let value = sum(&functions, &at);
            if value > want.0 {
                want = (value, at);
            }
        }
        let got = best(&domain, &functions);
        assert_eq!((got.value, got.at), want, "seed {seed}");
        let all: usize = functions.iter().map(|(_, f)| f.pieces().len()).product();
        cut_off += usize::from((got.branches as usize) < all);
        stream.shuffle(&mut functions);
        let again = best(&domain, &functions);
        assert_eq!((again.value, again.at), want, "seed {seed}, shuffled");
    }
    assert!(cut_off > 1_000, "branches were cut off in {cut_off} problems");
}

#[test]
fn boxes_of_one_point_are_the_function_itself() {
    let domain =
        Domain::new(vec![axis("x", -1.0, 1.0, 9), axis("other", 0.0, 1.0, 3), axis("y", 0.0, 2.0, 7)]).expect("fine");
    let utility = |v: &[f64]| 40.0 + 20.0 * v[0] * v[1];
    let exact = Piecewise::fitted(&domain, &[0, 2], Fit { side: 1, pieces_max: 0, tolerance: 0.0 }, utility);
    assert_eq!(exact.pieces().len(), 9 * 7);
    for at in points(&domain) {
        let values = [domain.axes()[0].value(f64::from(at[0])), domain.axes()[2].value(f64::from(at[2]))];
        let (got, want) = (exact.utility(&at), utility(&values));
        assert!((got - want).abs() < 1e-5, "{at:?}: {got}, not {want}");
    }
    assert_eq!(Piecewise::new(&domain, exact.pieces().to_vec()).as_ref(), Ok(&exact));
}

#[test]
fn a_linear_function_is_fitted_exactly_however_large_the_boxes() {
    let domain = Domain::new(vec![axis("x", 0.0, 10.0, 21), axis("y", 0.0, 1.0, 11)]).expect("fine");
    for side in [1, 2, 4, 5, 100] {
        let fit = Fit { side, pieces_max: 0, tolerance: 0.0 };
        let plane = Piecewise::fitted(&domain, &[0, 1], fit, |v| 10.0 + 5.0 * v[0] + 30.0 * v[1]);
        for at in points(&domain) {
            let want = 10.0 + 2.5 * f64::from(at[0]) + 3.0 * f64::from(at[1]);
            assert!((plane.utility(&at) - want).abs() < 1e-4, "side {side}, {at:?}");
        }
    }
}

#[test]
fn a_fit_gets_better_where_it_is_worst() {
    let domain = Domain::new(vec![axis("x", -1.0, 1.0, 101), axis("y", -1.0, 1.0, 101)]).expect("fine");
    // A plain with one hill in a corner.
    let hill = |v: &[f64]| {
        let square = (v[0] - 0.6) * (v[0] - 0.6) + (v[1] - 0.6) * (v[1] - 0.6);
        (100.0 - 400.0 * square).max(0.0)
    };
    let error = |function: &Piecewise| {
        let off = |at: Point| {
            let values = [domain.axes()[0].value(at[0].into()), domain.axes()[1].value(at[1].into())];
            (function.utility(&at) - hill(&values)).abs()
        };
        points(&domain).into_iter().map(off).sum::<f64>() / (101.0 * 101.0)
    };
    let mut last = f64::INFINITY;
    for pieces_max in [0, 60, 180, 600] {
        let fit = Fit { side: 26, pieces_max, tolerance: 0.01 };
        let function = Piecewise::fitted(&domain, &[0, 1], fit, hill);
        assert_eq!(function.pieces().len(), pieces_max.max(16));
        assert!(Piecewise::new(&domain, function.pieces().to_vec()).is_ok(), "a tiling");
        let now = error(&function);
        assert!(now < 0.6 * last, "{pieces_max} pieces: mean error {now}, before {last}");
        last = now;
    }
    let even = Piecewise::fitted(&domain, &[0, 1], Fit { side: 5, pieces_max: 0, tolerance: 0.0 }, hill);
    let same = Fit { side: 26, pieces_max: even.pieces().len(), tolerance: 0.0 };
    let refined = Piecewise::fitted(&domain, &[0, 1], same, hill);
    assert!(error(&refined) < 0.5 * error(&even), "{} against {}", error(&refined), error(&even));
}

#[test]
fn pieces_that_do_not_tile_are_refused() {
    let domain = Domain::new(vec![axis("x", 0.0, 1.0, 4)]).expect("fine");
    let piece = |low: u16, high: u16| {
        let (mut a, mut b) = (Point::default(), Point::default());
        (a[0], b[0]) = (low, high);
        Piece { low: a, high: b, ..Piece::default() }
    };
    let cases = [
        (vec![piece(0, 1), piece(2, 3)], None),
        (vec![piece(0, 1)], Some(PiecewiseError::Gap(2))),
        (vec![piece(0, 2), piece(2, 3)], Some(PiecewiseError::Overlap(0, 1))),
        (vec![piece(0, 4)], Some(PiecewiseError::Outside(0))),
        (vec![piece(2, 1), piece(0, 3)], Some(PiecewiseError::Outside(0))),
        (vec![Piece { at_zero: f64::NAN, ..piece(0, 3) }], Some(PiecewiseError::Number(0))),
        (vec![Piece { slope: [-501.0; AXES_MAX], ..piece(0, 3) }], Some(PiecewiseError::Number(0))),
    ];
    for (pieces, want) in cases {
        assert_eq!(Piecewise::new(&domain, pieces.clone()).err(), want, "{pieces:?}");
    }
}

#[test]
fn axes_that_make_no_domain_are_refused() {
    let x = || axis("x", 0.0, 1.0, 4);
    let cases = [
        (vec![], DomainError::Axes(0)),
        (vec![x(); 7], DomainError::Axes(7)),
        (vec![x(), x()], DomainError::Name("x".into())),
        (vec![Axis { points: 0, ..x() }], DomainError::Points("x".into(), 0)),
        (vec![Axis { high: -1.0, ..x() }], DomainError::Ends("x".into(), 0.0, -1.0)),
    ];
    for (axes, want) in cases {
        assert_eq!(Domain::new(axes), Err(want));
    }
}
