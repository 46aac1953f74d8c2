use super::*;
use ParameterValue::{Boolean, Double, Integer, NotSet, String as Text};
use std::sync::{Arc, Mutex};

/// A threshold from 0 to 1, a fixed name, and what was told of changes.
fn parameters() -> (Parameters, Arc<Mutex<Vec<String>>>) {
    let threshold = Arc::new(Mutex::new(0.25));
    let read = Arc::clone(&threshold);
    let told = Arc::new(Mutex::new(Vec::new()));
    let hearing = Arc::clone(&told);
    let live = Parameter::live(
        "detector.score_threshold",
        "least score",
        move || Double(*read.lock().expect("value")),
        move |value| {
            if let Double(number) = value {
                *threshold.lock().expect("value") = *number;
            }
            Ok(())
        },
    );
    let fixed = Parameter::fixed(
        "use_sim_time",
        "time from /clock",
        Boolean(false),
        "read at start",
    );
    let deep = Parameter::fixed("a.b.c", "deep", Integer(1), "read at start");
    let on_change = move |name: &str, _| hearing.lock().expect("list").push(name.to_owned());
    let list = vec![live.within(0.0, 1.0), fixed, deep];
    (Parameters::new(list, Box::new(on_change)), told)
}

fn set(parameters: &Parameters, name: &str, value: ParameterValue) -> Result<(), String> {
    parameters.set(vec![(name.to_owned(), value)])
}

#[test]
fn a_value_is_set_where_it_lives_and_whoever_listens_hears_of_it() {
    let (parameters, told) = parameters();
    assert_eq!(
        set(&parameters, "detector.score_threshold", Double(0.5)),
        Ok(())
    );
    assert_eq!(parameters.get("detector.score_threshold"), Double(0.5));
    // `ros2 param set … 1` sends an integer.
    assert_eq!(
        set(&parameters, "detector.score_threshold", Integer(1)),
        Ok(())
    );
    assert_eq!(parameters.get("detector.score_threshold"), Double(1.0));
    assert_eq!(told.lock().expect("list").len(), 2);
}

#[test]
fn what_cannot_be_set_says_why() {
    let (parameters, told) = parameters();
    let refused = |name, value| set(&parameters, name, value).expect_err("refused");
    assert_eq!(
        refused("detector.score_threshold", Text("high".to_owned())),
        "parameter `detector.score_threshold` is a double, not a string"
    );
    assert_eq!(
        refused("detector.score_threshold", Double(1.5)),
        "parameter `detector.score_threshold` is 0 to 1, 1.5 is out of range"
    );
    assert!(refused("detector.score_threshold", Double(f64::NAN)).contains("out of range"));
    assert_eq!(
        refused("use_sim_time", Boolean(true)),
        "parameter `use_sim_time` is fixed: read at start"
    );
    assert_eq!(
        refused("sesame", Boolean(true)),
        "parameter `sesame` was not declared"
    );
    assert_eq!(parameters.get("sesame"), NotSet);
    assert!(told.lock().expect("list").is_empty());
}

#[test]
fn all_or_none_are_set_together() {
    let (parameters, _told) = parameters();
    let both = vec![
        ("detector.score_threshold".to_owned(), Double(0.9)),
        ("use_sim_time".to_owned(), Boolean(true)),
    ];
    assert!(parameters.set(both).is_err());
    assert_eq!(parameters.get("detector.score_threshold"), Double(0.25));
}

#[test]
fn what_was_set_before_one_that_refuses_is_taken_back() {
    let threshold = Arc::new(Mutex::new(0.25));
    let (read, write) = (Arc::clone(&threshold), Arc::clone(&threshold));
    let number = move || Double(*read.lock().expect("value"));
    let set_number = move |value: &ParameterValue| {
        if let Double(number) = value {
            *write.lock().expect("value") = *number;
        }
        Ok(())
    };
    let refusing = |_: &ParameterValue| Err("no such class".to_owned());
    let told = Arc::new(Mutex::new(0));
    let hearing = Arc::clone(&told);
    let parameters = Parameters::new(
        vec![
            Parameter::live("a", "", number, set_number),
            Parameter::live("b", "", || Text(String::new()), refusing),
        ],
        Box::new(move |_, _| *hearing.lock().expect("count") += 1),
    );
    let both = vec![
        ("a".to_owned(), Double(0.9)),
        ("b".to_owned(), Text("unicorn".to_owned())),
    ];
    assert_eq!(
        parameters.set(both),
        Err("parameter `b`: no such class".to_owned())
    );
    assert_eq!(
        (
            *threshold.lock().expect("value"),
            *told.lock().expect("count")
        ),
        (0.25, 0)
    );
}

#[test]
fn names_are_listed_by_prefix_and_depth() {
    let (parameters, _told) = parameters();
    let listed = |prefixes: &[&str], depth| {
        let prefixes: Vec<String> = prefixes.iter().map(|&prefix| prefix.to_owned()).collect();
        parameters.list(&prefixes, depth)
    };
    let all = ["a.b.c", "detector.score_threshold", "use_sim_time"];
    assert_eq!(listed(&[], 0).names, all);
    assert_eq!(listed(&[], 0).prefixes, ["a.b", "detector"]);
    assert_eq!(listed(&[], 1).names, ["use_sim_time"]);
    assert_eq!(listed(&["a"], 1).names, Vec::<String>::new());
    assert_eq!(listed(&["a"], 2).names, ["a.b.c"]);
    assert_eq!(listed(&["detect"], 0).names, Vec::<String>::new());
    assert_eq!(listed(&["use_sim_time"], 1).names, ["use_sim_time"]);
}

#[test]
fn descriptors_tell_type_range_and_whether_it_is_fixed() {
    let (parameters, _told) = parameters();
    let described = parameters
        .find("detector.score_threshold")
        .expect("declared")
        .descriptor();
    assert_eq!(described.r#type, raw::ParameterType::DOUBLE);
    assert_eq!(described.description, "least score");
    assert!(!described.read_only);
    assert_eq!(described.floating_point_range[0].to_value, 1.0);
    assert!(
        parameters
            .find("use_sim_time")
            .expect("declared")
            .descriptor()
            .read_only
    );
}
