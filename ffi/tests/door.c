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
  EXPECT(foxhunt_clean_push(&clean, &observation, &generator, &answer) == FOXHUNT_RESULT_UNINITIALISED);
  EXPECT(foxhunt_generator_init(&generator, sizeof generator, 1) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_push(&clean, 0, &generator, &answer) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_push(&clean, &observation, 0, &answer) == FOXHUNT_RESULT_NULL_POINTER);
  EXPECT(foxhunt_clean_answer(&clean, 0) == FOXHUNT_RESULT_NULL_POINTER);
  /* An answer may be dropped. */
  EXPECT(foxhunt_clean_push(&clean, &observation, &generator, 0) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_vehicle_push(&vehicle, 0, 'x', 0) == FOXHUNT_RESULT_UNINITIALISED);
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
  EXPECT(foxhunt_clean_push(&clean, &wrong, &generator, &answer) == FOXHUNT_RESULT_BEARING);
  EXPECT(foxhunt_clean_answer(&clean, &answer) == FOXHUNT_RESULT_OK);
  EXPECT(answer.kind == FOXHUNT_ANSWER_KIND_TOO_FEW_BEARINGS && answer.have == 1);
  EXPECT(foxhunt_clean_push(&clean, &right, &generator, &answer) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_push(&clean, &right, &generator, &answer) == FOXHUNT_RESULT_DUPLICATE);
}

static void configurations(void) {
  FoxhuntCleanConfig config;
  foxhunt_clean_config_default(&config);
  EXPECT(says(foxhunt_clean_config_fault(&config), ""));
  config.moves = 256 + 2;
  EXPECT(foxhunt_clean_init(&clean, sizeof clean, &config) == FOXHUNT_RESULT_CONFIG);
  EXPECT(says(foxhunt_clean_config_fault(&config), "moves must be from 1 to 16"));
  EXPECT(foxhunt_clean_config_fault(0).length > 0);
  FoxhuntRobustConfig errors;
  foxhunt_robust_config_default(&errors);
  EXPECT(errors.direct == 0.8f && isinf(errors.correlation_time_s));
  errors.biases = 7;
  EXPECT(foxhunt_robust_init(&robust, sizeof robust, &errors) == FOXHUNT_RESULT_CONFIG);
  FoxhuntVehicleConfig lines;
  foxhunt_vehicle_config_default(&lines);
  lines.lines.finder = 99;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &lines) == FOXHUNT_RESULT_CONFIG);
  lines.lines.finder = FOXHUNT_FINDER_KRAKEN;
  lines.lines.frequencies = 1;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &lines) == FOXHUNT_RESULT_NULL_POINTER);
  static const uint32_t frequency_hz = 433920000;
  lines.lines.frequencies_hz = &frequency_hz;
  lines.lines.is_station = 1;
  lines.lines.station_heading_deg = 361;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &lines) == FOXHUNT_RESULT_CONFIG);
  EXPECT(foxhunt_vehicle_config_fault(&lines).length > 0);
  lines.lines.station_heading_deg = 360;
  EXPECT(foxhunt_vehicle_init(&vehicle, sizeof vehicle, &lines) == FOXHUNT_RESULT_OK);
}

static void texts(void) {
  EXPECT(says(foxhunt_error_text(FOXHUNT_RESULT_NULL_POINTER), "a pointer is null"));
  EXPECT(says(foxhunt_error_text(FOXHUNT_RESULT_DUPLICATE), "a bearing of this station and time was taken already"));
  EXPECT(says(foxhunt_error_text(-1), "unknown result"));
  EXPECT(says(foxhunt_rejected_text(0), "checksum is wrong or missing"));
  EXPECT(says(foxhunt_rejected_text(1000), ""));
  EXPECT(says(foxhunt_beacon_rejected_text(1000), ""));
}

int main(int count, char **arguments) {
  pointers();
  observations();
  configurations();
  texts();
  EXPECT(count == 2);
  locators(arguments[1]);
  return 0;
}
