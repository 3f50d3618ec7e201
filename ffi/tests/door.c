/* What the door refuses: null, not aligned, of another size, not initialised, of another type, out of range. */

#include <math.h>
#include <string.h>

#include "expect.h"
#include "foxhunt.h"

void locators(const char *data);

static FoxhuntClean clean;
static FoxhuntRobust robust;
static FoxhuntVehicle vehicle;
static FoxhuntGenerator generator;

static int says(FoxhuntText text, const char *expected) {
  return text.length == strlen(expected) && memcmp(text.bytes, expected, text.length) == 0;
}

static int begins(FoxhuntText text, const char *expected) {
  return text.length >= strlen(expected) && memcmp(text.bytes, expected, strlen(expected)) == 0;
}

static void pointers(void) {
  FoxhuntCleanConfig config;
  FoxhuntAnswer answer;
  FoxhuntObservation observation = {.sigma_rad = 0.02f};
  EXPECT(foxhunt_clean_config_default(0) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_config_default(&config) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_init(0, sizeof clean, &config) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_init(&clean, sizeof clean, 0) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_init(&clean, sizeof clean - 8, &config) == FOXHUNT_RESULT_SIZE);
  FoxhuntClean *crooked = (FoxhuntClean *)(void *)((char *)&clean + 4);
  EXPECT(foxhunt_clean_init(crooked, sizeof clean, &config) == FOXHUNT_RESULT_MISALIGNED);
  /* Storage that nobody has initialised, or that holds another type. */
  EXPECT(foxhunt_clean_answer(&clean, &answer) == FOXHUNT_RESULT_UNINITIALISED);
  EXPECT(foxhunt_clean_reset(&clean) == FOXHUNT_RESULT_UNINITIALISED);
  EXPECT(foxhunt_clean_init(&clean, sizeof clean, &config) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_robust_answer((FoxhuntRobust *)(void *)&clean, &answer) == FOXHUNT_RESULT_UNINITIALISED);
  EXPECT(foxhunt_clean_push(&clean, &observation, &generator, &answer) == FOXHUNT_RESULT_NO_GENERATOR);
  EXPECT(foxhunt_generator_init(&generator, sizeof generator, 1) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_push(&clean, 0, &generator, &answer) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_push(&clean, &observation, 0, &answer) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_answer(&clean, 0) == FOXHUNT_RESULT_NULL_POINTER);
  /* An answer may be dropped. */
  EXPECT(foxhunt_clean_push(&clean, &observation, &generator, 0) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_vehicle_push(&vehicle, 0, 'x', 0) == FOXHUNT_RESULT_UNINITIALISED);
  FoxhuntPlace place;
  EXPECT(foxhunt_vehicle_place(&vehicle, 0, 0, &place) == FOXHUNT_RESULT_UNINITIALISED);
  FoxhuntTrackerConfig tags;
  static FoxhuntSite site;
  foxhunt_tracker_config_default(&tags);
  EXPECT(foxhunt_site_init(&site, sizeof site, 0, 0, &tags) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_site_init(&site, sizeof site, 0, 100, &tags) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_site_init(&site, sizeof site, (const uint8_t *)"a text", 6, &tags) == FOXHUNT_RESULT_MAP_MAGIC);
  EXPECT(foxhunt_vehicle_report(&vehicle).length == 0);
  EXPECT(foxhunt_vehicle_report(0).length == 0);
}

static void observations(void) {
  FoxhuntAnswer answer;
  const FoxhuntObservation right = {.time_ms = 5000, .sigma_rad = 0.02f};
  FoxhuntObservation wrong = right;
  wrong.sigma_rad = 0;
  EXPECT(foxhunt_clean_push(&clean, &wrong, &generator, &answer) == FOXHUNT_RESULT_SIGMA);
  wrong = right;
  wrong.east_m = NAN;
  EXPECT(foxhunt_clean_push(&clean, &wrong, &generator, &answer) == FOXHUNT_RESULT_POSITION);
  wrong = right;
  wrong.bearing_rad = INFINITY;
  EXPECT(foxhunt_clean_push(&clean, &wrong, &generator, &answer) == FOXHUNT_RESULT_BEARING);
  wrong = right;
  wrong.heading_rad = NAN;
  EXPECT(foxhunt_clean_push(&clean, &wrong, &generator, &answer) == FOXHUNT_RESULT_HEADING);
  EXPECT(foxhunt_clean_answer(&clean, &answer) == FOXHUNT_RESULT_OK);
  EXPECT(answer.kind == FOXHUNT_ANSWER_KIND_TOO_FEW_BEARINGS && answer.have == 1);
  EXPECT(foxhunt_clean_push(&clean, &right, &generator, &answer) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_push(&clean, &right, &generator, &answer) == FOXHUNT_RESULT_DUPLICATE);
}

static void ellipses(void) {
  const FoxhuntSymmetric2 right = {4, 0, 1}, line = {4, 2, 1};
  FoxhuntEllipse ellipse;
  EXPECT(foxhunt_ellipse(&right, 0.95f, &ellipse) == FOXHUNT_RESULT_OK);
  EXPECT(fabsf(ellipse.semi_major_m - 4.9f) < 0.01f && fabsf(ellipse.semi_minor_m - 2.45f) < 0.01f);
  EXPECT(foxhunt_ellipse(&line, 0.95f, &ellipse) == FOXHUNT_RESULT_OK);
  EXPECT(ellipse.semi_minor_m == 0);
  EXPECT(foxhunt_ellipse(&right, 0, &ellipse) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_ellipse(&right, 1, &ellipse) == FOXHUNT_RESULT_OK);
  const float probabilities[] = {95, -0.1f, 1.001f, NAN, INFINITY};
  for (size_t i = 0; i < sizeof probabilities / sizeof probabilities[0]; i++) {
    EXPECT(foxhunt_ellipse(&right, probabilities[i], &ellipse) == FOXHUNT_RESULT_PROBABILITY);
  }
  const FoxhuntSymmetric2 wrong[] = {{-4, 0, 1}, {4, 0, -1}, {NAN, 0, 1}, {4, INFINITY, 1}, {4, 2.1f, 1}, {0, 0.1f, 1}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    EXPECT(foxhunt_ellipse(&wrong[i], 0.95f, &ellipse) == FOXHUNT_RESULT_COVARIANCE);
  }
}

static void configurations(void) {
  FoxhuntCleanConfig config;
  foxhunt_clean_config_default(&config);
  EXPECT(says(foxhunt_clean_config_fault(&config), ""));
  config.moves = 256 + 2;
  EXPECT(foxhunt_clean_init(&clean, sizeof clean, &config) == FOXHUNT_RESULT_CONFIG);
  EXPECT(says(foxhunt_clean_config_fault(&config), "moves must be from 1 to 16"));
  EXPECT(says(foxhunt_clean_config_fault(0), "a pointer is null"));
  FoxhuntTrackerConfig tags;
  foxhunt_tracker_config_default(&tags);
  tags.highest_dbm = tags.lowest_dbm + 5;
  EXPECT(begins(foxhunt_tracker_config_fault(&tags), "lowest_dbm and highest_dbm must be"));
}

/* A field that is out of range is named as in C. */
static void errors(void) {
  FoxhuntRobustConfig right, wrong;
  foxhunt_robust_config_default(&right);
  EXPECT(right.direct == 0.8f && isinf(right.correlation_time_s));
  wrong = right;
  wrong.biases = 7;
  EXPECT(foxhunt_robust_init(&robust, sizeof robust, &wrong) == FOXHUNT_RESULT_CONFIG);
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "biases must be from 0 to 2"));
  wrong = right;
  wrong.direct = 0.5f;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "direct, mirrored and outlier must add up to 1"));
  wrong = right;
  wrong.correlation_at_rest = 1;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "correlation_at_rest must be from 0 to 0.999"));
  wrong.correlation_at_rest = 0.999f;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), ""));
  wrong.correlation_distance = 1.1f;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "correlation_distance must be from 0 to 1"));
  wrong = right;
  wrong.correlation_distance_m = 2e6f;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "correlation_distance_m must be from 0 to 1e6"));
  wrong = right;
  wrong.correlation_time_s = 0;
  EXPECT(says(foxhunt_robust_config_fault(&wrong), "correlation_time_s must be at least 0.001"));
}

static void gateways(void) {
  FoxhuntVehicleConfig config;
  FoxhuntLineConfig *lines = &config.lines;
  foxhunt_vehicle_config_default(&config);
  /* As the header says. */
  const float degree = 3.14159265f / 180;
  EXPECT(lines->seed == 1 && lines->min_quality == 40 && lines->max_age_ms == 2000 && lines->undated_bearings == 20);
  EXPECT(fabsf(lines->best_sigma_rad - 2 * degree) < 1e-6f && fabsf(lines->worst_sigma_rad - 10 * degree) < 1e-6f);
  EXPECT(lines->min_speed_m_s == 1.5f && lines->max_turn_rate_deg_s == 10 && lines->max_speed_m_s == 100);
  EXPECT(lines->report_interval_ms == 1000 && lines->finder == 0 && lines->reference == 0 && lines->simulated == 0);
  EXPECT(lines->is_station == 0 && lines->has_variation == 0 && lines->frequencies == 0 && lines->frequencies_hz == 0);
  lines->finder = 99;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_CONFIG);
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "finder must be from 0 to 5"));
  lines->finder = FOXHUNT_FINDER_KRAKEN;
  lines->reference = 2;
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "reference must be 0 or 1"));
  lines->reference = FOXHUNT_REFERENCE_TRUE_NORTH;
  lines->undated_bearings = 256;
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "undated_bearings must be at most 255"));
  lines->undated_bearings = 255;
  lines->frequencies = 1;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "a pointer is null"));
  static const uint32_t frequency_hz = 433920000;
  lines->frequencies_hz = &frequency_hz;
  lines->is_station = 1;
  lines->station_heading_deg = 361;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_CONFIG);
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "station_heading_deg must be from 0 to 360"));
  lines->station_heading_deg = 360;
  lines->station_latitude_e7 = 2000000000;
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "station_latitude_e7 must be from -90 to 90 degrees"));
  lines->station_latitude_e7 = 0;
  lines->station_longitude_e7 = -2000000000;
  EXPECT(says(foxhunt_vehicle_config_fault(&config), "station_longitude_e7 must be from -180 to 180 degrees"));
  lines->station_longitude_e7 = 0;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_OK);
  FoxhuntEvent event;
  EXPECT(foxhunt_vehicle_push(&vehicle, FOXHUNT_PORTS, '\n', &event) == FOXHUNT_RESULT_PORT);
  EXPECT(foxhunt_vehicle_push(&vehicle, FOXHUNT_PORTS - 1, '\n', &event) == FOXHUNT_RESULT_OK);
  FoxhuntPlace place;
  EXPECT(foxhunt_vehicle_place(&vehicle, 0, 0, &place) == FOXHUNT_RESULT_NOTHING);
}

static void texts(void) {
  EXPECT(says(foxhunt_error_text(FOXHUNT_RESULT_NULL_POINTER), "a pointer is null"));
  EXPECT(says(foxhunt_error_text(FOXHUNT_RESULT_DUPLICATE), "a bearing of this station and time was taken already"));
  EXPECT(says(foxhunt_error_text(-1), "unknown result"));
  EXPECT(says(foxhunt_answer_text(FOXHUNT_ANSWER_KIND_SEVERAL_PLACES), "several places fit"));
  EXPECT(says(foxhunt_answer_text(1000), ""));
  EXPECT(says(foxhunt_rejected_text(0), "checksum is wrong or missing"));
  EXPECT(says(foxhunt_rejected_text(1000), ""));
  EXPECT(says(foxhunt_beacon_rejected_text(1000), ""));
}

int main(int count, char **arguments) {
  pointers();
  observations();
  ellipses();
  configurations();
  errors();
  gateways();
  texts();
  EXPECT(count == 2);
  locators(arguments[1]);
  return 0;
}
