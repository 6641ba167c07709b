//! Recordings with coordinates of a map: `GeoJSON`, GPX, systems of coordinates in metres, and latitudes that look like
//! longitudes.

use std::fs;

use serde_json::{Value, json};

use crate::recordings::{answer, degrees, file, near, rows, sign};
use crate::{folder, prints, refuses};

const ORIGIN: [f64; 2] = [53.5334, 9.9424];

/// Latitude, longitude and label of samples about the origin.
fn places() -> Vec<([f64; 2], bool)> {
    rows(60).into_iter().map(|(at, label)| (degrees(ORIGIN, at), label)).collect()
}

fn point([lat, lon]: [f64; 2], properties: &Value) -> Value {
    json!({
        "type": "Feature",
        "geometry": { "type": "Point", "coordinates": [lon, lat] },
        "properties": properties,
    })
}

fn collection(features: &[Value]) -> String {
    serde_json::to_string_pretty(&json!({ "type": "FeatureCollection", "features": features }))
        .expect("JSON")
}

fn read_back(path: &std::path::Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("a map")).expect("JSON")
}

#[test]
fn geojson_points_are_samples() {
    let folder = folder();
    let table =
        file("lat,lon,label", &places(), |[lat, lon], l| format!("{lat},{lon},{}", sign(l)));
    let expected = answer(folder.path(), &table, &[]);
    let of = |value: &dyn Fn(bool) -> Value, key: &str| {
        let point = |(at, label): &([f64; 2], bool)| point(*at, &json!({ key: value(*label) }));
        places().iter().map(point).collect::<Vec<_>>()
    };
    let kinds: [(Vec<Value>, &[&str]); 4] = [
        (of(&|l| sign(l).into(), "label"), &[]),
        (of(&|l| l.into(), "wet"), &["--columns", "label=wet"]),
        (of(&|l| if l { "ja" } else { "nein" }.into(), "oil"), &["--columns", "label=oil"]),
        (
            of(&|l| if l { 7.5 } else { 2.5 }.into(), "ppm"),
            &["--columns", "label=ppm", "--threshold", "5"],
        ),
    ];
    for (features, flags) in &kinds {
        let found = answer(folder.path(), &collection(features), flags);
        assert_eq!(&found, &expected, "{flags:?}");
    }
    // Features without a label or a place, or of another shape, are skipped and counted.
    let mut features = kinds[0].0.clone();
    features[4]["properties"]["label"] = Value::Null;
    features[7]["geometry"] = Value::Null;
    features[9]["geometry"] =
        json!({ "type": "LineString", "coordinates": [[9.9, 53.5], [9.8, 53.5]] });
    let content = collection(&features);
    let found = answer(folder.path(), &content, &[]);
    assert_eq!(found["skipped"], json!({ "rows": 3, "first": 5 }));
    let words = prints(folder.path(), &["replay", "s.csv"]);
    assert!(words.contains("Skipped 3 features") && words.contains("feature 5"), "{words}");
    refuses(folder.path(), &["replay", "s.csv", "--strict"], &["s.csv: feature 5: ", "--strict"]);
    // Our own map comes back as the samples that it was made of.
    prints(folder.path(), &["replay", "s.csv", "--geojson", "own.geojson"]);
    let own = fs::read_to_string(folder.path().join("own.geojson")).expect("a map");
    assert_eq!(answer(folder.path(), &own, &[])["samples"], 57);
}

#[test]
fn geojson_that_cannot_be_read_is_refused_by_feature() {
    let folder = folder();
    let one = |geometry: Value, properties: Value| {
        collection(&[json!({ "type": "Feature", "geometry": geometry, "properties": properties })])
    };
    let at = |x: f64, y: f64| json!({ "type": "Point", "coordinates": [x, y] });
    let mut utm: Value =
        serde_json::from_str(&one(at(565_000.0, 5_932_000.0), json!({ "label": 1 })))
            .expect("JSON");
    utm["crs"] = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::25832" } });
    let cases: [(String, &[&str], &[&str]); 9] = [
        (
            one(at(9.9, 53.5), json!({ "oil": 1, "depth": 2 })),
            &[],
            &["s.csv: feature 1", "--columns label=", "oil", "depth"],
        ),
        (
            one(at(9.9, 53.5), json!({ "oil": 1 })),
            &["--columns", "label=wet"],
            &["--columns label=wet", "oil"],
        ),
        (
            one(at(9.9, 53.5), json!({ "label": 3 })),
            &[],
            &["s.csv: feature 1: label", "3", "--threshold"],
        ),
        (one(at(9.9, 53.5), json!({ "label": [1] })), &[], &["s.csv: feature 1: label", "[1]"]),
        (
            one(at(9.9, 53.5), json!({ "label": 1 })),
            &["--columns", "lat=a,lon=b"],
            &["--columns", "label=", "GeoJSON"],
        ),
        (
            one(at(9.9, 53.5), json!({ "label": 1 })),
            &["--delimiter", ";"],
            &["--delimiter", "GeoJSON"],
        ),
        (utm.to_string(), &[], &["s.csv", "EPSG:25832", "--crs EPSG:25832"]),
        ("{\"type\":\"FeatureCollection\",\"features\":[".to_owned(), &[], &["s.csv:1", "GeoJSON"]),
        (
            "{\"type\":\"Polygon\",\"coordinates\":[]}".to_owned(),
            &[],
            &["s.csv", "Polygon", "FeatureCollection"],
        ),
    ];
    for (content, flags, parts) in cases {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        refuses(folder.path(), &[&["replay", "s.csv"], flags].concat(), parts);
    }
}

fn gpx(kind: &str, inner: impl Fn(bool) -> String) -> String {
    let points = places().into_iter().map(|([lat, lon], label)| {
        format!("<{kind} lat=\"{lat}\" lon=\"{lon}\"><ele>1</ele>{}</{kind}>\n", inner(label))
    });
    let points: String = points.collect();
    let points =
        if kind == "trkpt" { format!("<trk><trkseg>\n{points}</trkseg></trk>") } else { points };
    format!(
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"a\" xmlns=\"http://www.topografix.com/GPX/1/1\" \
         xmlns:s=\"urn:s\">\n{points}</gpx>\n"
    )
}

#[test]
fn gpx_points_are_samples() {
    let folder = folder();
    let table =
        file("lat,lon,label", &places(), |[lat, lon], l| format!("{lat},{lon},{}", sign(l)));
    let expected = answer(folder.path(), &table, &[]);
    let answers = |l: bool| if l { "yes" } else { "no" };
    let kinds: [(String, &[&str]); 5] = [
        (gpx("wpt", |l| format!("<name>{}</name>", answers(l))), &["--columns", "label=name"]),
        (gpx("wpt", |l| format!("<type> {} </type>", sign(l))), &["--columns", "label=type"]),
        (gpx("rtept", |l| format!("<desc>{}</desc>", answers(l))), &["--columns", "label=desc"]),
        (
            gpx("trkpt", |l| format!("<extensions><s:oil>{}</s:oil></extensions>", i32::from(l))),
            &["--columns", "label=oil"],
        ),
        (
            gpx("trkpt", |l| {
                let ppm = if l { 1_200.5 } else { 3.0 };
                format!("<extensions><s:a><s:label>{ppm}</s:label></s:a></extensions>")
            }),
            &["--threshold", "10"],
        ),
    ];
    for (content, flags) in &kinds {
        assert_eq!(answer(folder.path(), content, flags), expected, "{flags:?}");
    }
    // A byte order mark, and a point without a label on line 4.
    let content = format!("\u{feff}{}", kinds[0].0).replacen(
        "<wpt",
        "<wpt lat=\"53.5\" lon=\"9.9\"/>\n<wpt",
        2,
    );
    let found = answer(folder.path(), &content, kinds[0].1);
    assert_eq!(found["skipped"]["rows"], 2);
    assert_eq!(found["skipped"]["first"], 3);
    refuses(
        folder.path(),
        &["replay", "s.csv", "--columns", "label=name", "--strict"],
        &["s.csv:3: ", "--strict"],
    );
}

#[test]
fn gpx_that_cannot_be_read_is_refused_by_line() {
    let folder = folder();
    let gpx = |inner: &str| format!("<gpx version=\"1.1\">\n{inner}\n</gpx>\n");
    let point = "<wpt lat=\"53.5\" lon=\"9.9\"><name>yes</name><sym>Dot</sym></wpt>";
    let cases: [(String, &[&str], &[&str]); 8] = [
        (gpx(point), &[], &["s.csv:2", "--columns label=", "name", "sym"]),
        (gpx(point), &["--columns", "label=wet"], &["--columns label=wet", "name", "sym"]),
        (gpx(point), &["--columns", "x=a,z=b,label=name"], &["--columns", "label=", "GPX"]),
        (
            gpx("<wpt lon=\"9.9\"><name>yes</name></wpt>"),
            &["--columns", "label=name"],
            &["s.csv:2", "lat"],
        ),
        (
            gpx("<wpt lat=\"x\" lon=\"9.9\"><name>yes</name></wpt>"),
            &["--columns", "label=name"],
            &["s.csv:2", "lat", "\"x\""],
        ),
        (gpx(""), &[], &["s.csv", "no points", "wpt"]),
        ("<gpx>\n<wpt\n".to_owned(), &[], &["s.csv:", "XML"]),
        ("<kml></kml>".to_owned(), &[], &["s.csv:1", "\"kml\"", "gpx"]),
    ];
    for (content, flags, parts) in cases {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        refuses(folder.path(), &[&["replay", "s.csv"], flags].concat(), parts);
    }
}

/// The same samples in metres of UTM zone 32 (by pyproj, an independent library), whose origin is at 565000, 5932000.
#[test]
fn metres_of_a_known_system_have_a_place_on_the_map() {
    let folder = folder();
    let metres = file("x,z,label", &rows(60), |[x, z], l| {
        format!("{:.3},{:.3},{}", x + 565_000.0, z + 5_932_000.0, sign(l))
    });
    let plain = answer(folder.path(), &metres, &[]);
    let found = answer(folder.path(), &metres, &["--crs", "EPSG:25832", "--geojson", "m.geojson"]);
    assert_eq!(found["crs"], "EPSG:25832");
    // Metres stay metres.
    assert_eq!(found["estimates"], plain["estimates"]);
    assert_eq!(found["in_file"], plain["in_file"]);
    let map = read_back(&folder.path().join("m.geojson"));
    let features = map["features"].as_array().expect("features");
    let samples: Vec<_> =
        features.iter().filter(|it| it["properties"]["kind"] == "sample").collect();
    assert_eq!(samples.len(), 60);
    // Of a position to the millimetre, the first row's.
    let first = &samples[0]["geometry"]["coordinates"];
    let [x, z] = rows(60)[0].0;
    let [lon, lat] = KNOWN;
    near(&first[0], lon, 2e-9);
    near(&first[1], lat, 2e-9);
    assert!(x > 0.0 && z > 0.0);
    for (flags, parts) in [
        (&["--crs", "25832"][..], &["--crs", "EPSG:"][..]),
        (&["--crs", "EPSG:1"], &["--crs", "EPSG:1", "unknown"]),
        (&["--crs", "EPSG:4326"], &["--crs", "EPSG:4326", "degrees", "lat="]),
        // Web Mercator stretches lengths; feet are no metres.
        (&["--crs", "EPSG:3857"], &["--crs", "EPSG:3857", "metre", "s.csv"]),
        (&["--crs", "EPSG:2263"], &["--crs", "EPSG:2263", "us-ft"]),
        (&["--crs", "EPSG:25832", "--columns", "x=z,z=x"], &["--crs", "EPSG:25832", "x and z"]),
        (&["--crs", "EPSG:25832", "--columns", "lat=x,lon=z"], &["--crs", "metres"]),
        (&["--geojson", "m2.geojson"], &["--geojson", "s.csv", "--crs"]),
    ] {
        refuses(folder.path(), &[&["replay", "s.csv"], flags].concat(), parts);
    }
}

/// Longitude and latitude of the first row.
const KNOWN: [f64; 2] = [9.980_837_529_477, 53.533_058_856_919];

#[test]
fn latitudes_that_look_like_longitudes_are_told() {
    let folder = folder();
    let swapped = file("lat,lon,label", &rows(60), |at, l| {
        let [lat, lon] = degrees([-33.86, 151.2], at);
        format!("{lon},{lat},{}", sign(l))
    });
    fs::write(folder.path().join("s.csv"), &swapped).expect("a file");
    let parts = ["s.csv:2: ", "latitude", "swapped", "--columns lat=lon,lon=lat"];
    refuses(folder.path(), &["replay", "s.csv"], &parts);
    // As the message says.
    let right = swapped.replace("lat,lon,label", "lon,lat,label");
    let expected = answer(folder.path(), &right, &[]);
    let found = answer(folder.path(), &swapped, &["--columns", "lat=lon,lon=lat"]);
    assert_eq!(found, expected);
    // In GeoJSON, whose order is fixed.
    let feature = |([x, z], l): &([f64; 2], bool)| {
        let [lat, lon] = degrees([-33.86, 151.2], [*x, *z]);
        point([lon, lat], &json!({ "label": sign(*l) }))
    };
    let features: Vec<_> = rows(60).iter().map(feature).collect();
    fs::write(folder.path().join("s.csv"), collection(&features)).expect("a file");
    refuses(
        folder.path(),
        &["replay", "s.csv"],
        &["s.csv: feature 1: ", "swapped", "longitude first"],
    );
    // One bad latitude among good ones is no swap.
    let one = "lat,lon,label\n53.5,9.9,1\n95,9.9,1\n53.5,9.8,-1\n";
    fs::write(folder.path().join("s.csv"), one).expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:3: ", "lat: found 95"]);
    assert_eq!(expected["samples"], 60);
}
