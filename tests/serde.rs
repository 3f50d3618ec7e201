//! Configurations and answers as values of `serde`. As TOML, which has infinite numbers; JSON has none.

use foxhunt::aoa::{
    Answer, Bearing, Clean, Locator, Observation, clean,
    manoeuvring::{self, Config},
    multi,
};
use foxhunt::fingerprint::tracker;
use foxhunt::gateway;
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
use serde::{Serialize, de::DeserializeOwned};

fn there_and_back<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: T) {
    let text = toml::to_string(&value).unwrap();
    assert_eq!(toml::from_str::<T>(&text).unwrap(), value, "{text}");
}

fn as_json<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: T) {
    let text = serde_json::to_string(&value).unwrap();
    assert_eq!(serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
}

#[test]
fn configurations_come_back_as_they_were() {
    there_and_back(Config::WALKER);
    there_and_back(multi::Config::new(manoeuvring::Config::DEFAULT));
    as_json(<clean::Config>::DEFAULT);
    there_and_back(tracker::Config::DEFAULT);
}

#[test]
fn a_missing_field_is_named() {
    let mut value = toml::Table::try_from(Config::DEFAULT).unwrap();
    value.remove("moving_s");
    let error = value.try_into::<Config>().unwrap_err();
    assert!(error.to_string().contains("moving_s"), "{error}");
}

#[test]
fn answers_come_back_as_they_were() {
    let mut locator = Locator::<Clean<100>>::new(clean::Config::DEFAULT).unwrap();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    for (s, degrees) in [36.6, 20.8, 359.7, 339.9].into_iter().enumerate() {
        let bearing = Bearing::from_compass_degrees(degrees);
        let place = [300.0 * s as f32, 0.0];
        let observation = Observation::new(20_000 * s as u32, place, bearing, 0.02).unwrap();
        as_json(locator.push(&observation, &mut rng).unwrap());
    }
    assert!(matches!(locator.answer(), Answer::Fix(_)));
    as_json(locator.source(0).unwrap());
}

#[test]
fn what_a_gateway_was_told_can_be_recorded() {
    let config = gateway::Config::new(<clean::Config>::DEFAULT);
    let value = serde_json::to_value(config).unwrap();
    assert_eq!(value["max_age_ms"], config.max_age_ms);
}
