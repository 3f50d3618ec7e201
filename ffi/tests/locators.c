/* Every locator finds the source of the README, the tracker somebody in a tunnel, and both gateways answer. */

#include <math.h>
#include <string.h>

#include "expect.h"
#include "foxhunt.h"

void locators(const char *data);

/* Driving east, past a transmitter 800 m to the north of 600 m: seconds, metres, degrees. */
static const float drive[][3] = {
    {0, 0, 36.6f},     {10, 150, 29.5f}, {20, 300, 20.8f},  {30, 450, 10.9f},
    {40, 600, 359.7f}, {50, 750, 349.0f}, {60, 900, 339.9f},
};
enum { BEARINGS = sizeof drive / sizeof drive[0] };

static FoxhuntGenerator generator;

static FoxhuntObservation observation(int index) {
  FoxhuntObservation one = {
      .time_ms = (uint32_t)(1000 * drive[index][0]),
      .east_m = drive[index][1],
      .bearing_rad = foxhunt_from_compass(drive[index][2]),
      .sigma_rad = 0.02f,
  };
  return one;
}

static void expect_source(const FoxhuntFix *fix) {
  EXPECT(fabsf(fix->east_m - 600) < 60 && fabsf(fix->north_m - 800) < 120);
  FoxhuntEllipse ellipse;
  EXPECT(foxhunt_ellipse(&fix->covariance, 0.95f, &ellipse) == FOXHUNT_RESULT_OK);
  EXPECT(ellipse.semi_major_m >= ellipse.semi_minor_m && ellipse.semi_minor_m > 0 && ellipse.semi_major_m < 400);
}

static void clean_locator(void) {
  static FoxhuntClean locator;
  FoxhuntCleanConfig config;
  FoxhuntAnswer answer;
  foxhunt_clean_config_default(&config);
  EXPECT(foxhunt_clean_init(&locator, sizeof locator, &config) == FOXHUNT_RESULT_OK);
  for (int i = 0; i < BEARINGS; i++) {
    FoxhuntObservation one = observation(i);
    EXPECT(foxhunt_clean_push(&locator, &one, &generator, &answer) == FOXHUNT_RESULT_OK);
  }
  EXPECT(answer.kind == FOXHUNT_ANSWER_KIND_FIX && answer.fix.bearings == BEARINGS);
  expect_source(&answer.fix);
  /* Storage may be copied. */
  FoxhuntClean *copy = malloc(sizeof *copy);
  EXPECT(copy != 0);
  *copy = locator;
  FoxhuntAnswer same;
  EXPECT(foxhunt_clean_answer(copy, &same) == FOXHUNT_RESULT_OK);
  EXPECT(same.fix.east_m == answer.fix.east_m);
  free(copy);
  EXPECT(foxhunt_clean_reset(&locator) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_clean_answer(&locator, &answer) == FOXHUNT_RESULT_OK);
  EXPECT(answer.kind == FOXHUNT_ANSWER_KIND_TOO_FEW_BEARINGS && answer.fix.bearings == 0);
}

static void robust_locator(void) {
  static FoxhuntRobust locator;
  FoxhuntRobustConfig config;
  FoxhuntAnswer answer;
  FoxhuntHypothesis hypothesis;
  foxhunt_robust_config_default(&config);
  EXPECT(foxhunt_robust_init(&locator, sizeof locator, &config) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_robust_hypothesis(&locator, 0, &hypothesis) == FOXHUNT_RESULT_NOTHING);
  for (int i = 0; i < BEARINGS; i++) {
    FoxhuntObservation one = observation(i);
    EXPECT(foxhunt_robust_push(&locator, &one, &generator, &answer) == FOXHUNT_RESULT_OK);
  }
  EXPECT(answer.kind == FOXHUNT_ANSWER_KIND_FIX);
  expect_source(&answer.fix);
  EXPECT(foxhunt_robust_hypothesis(&locator, 0, &hypothesis) == FOXHUNT_RESULT_OK);
  EXPECT(hypothesis.probability > 0 && hypothesis.probability <= 1);
}

static void several_sources(void) {
  static FoxhuntSeveral locator;
  FoxhuntSeveralConfig config;
  FoxhuntAnswer answer;
  FoxhuntSource source;
  foxhunt_several_config_city(&config);
  EXPECT(foxhunt_several_init(&locator, sizeof locator, &config) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_several_source(&locator, 0, &source) == FOXHUNT_RESULT_NOTHING);
  for (int i = 0; i < BEARINGS; i++) {
    FoxhuntObservation one = observation(i);
    EXPECT(foxhunt_several_push(&locator, &one, &generator, &answer) == FOXHUNT_RESULT_OK);
  }
  if (answer.kind == FOXHUNT_ANSWER_KIND_FIX) {
    EXPECT(foxhunt_several_source(&locator, 0, &source) == FOXHUNT_RESULT_OK);
    EXPECT(source.probability > 0 && source.probability <= 1);
  }
  EXPECT(foxhunt_several_reset(&locator) == FOXHUNT_RESULT_OK);
}

static uint8_t map[8192];

/* Reads a file into memory, and returns its length. */
static size_t read_file(const char *data, const char *name, void *bytes, size_t room) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", data, name);
  FILE *file = fopen(path, "rb");
  EXPECT(file != 0);
  size_t length = fread(bytes, 1, room, file);
  EXPECT(length < room);
  fclose(file);
  return length;
}

static void tags(const char *data) {
  static FoxhuntSite site;
  static FoxhuntTracker tracker;
  static FoxhuntWorkspace workspace;
  FoxhuntTrackerConfig config;
  FoxhuntTagFix fix;
  foxhunt_tracker_config_tunnel(&config);
  EXPECT(foxhunt_tracker_init(&tracker, sizeof tracker) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_tracker_push(&tracker, 0, 0, -60, &site, &workspace, &generator, 0, 0) == FOXHUNT_RESULT_NO_SITE);
  size_t length = read_file(data, "tunnel.map", map, sizeof map);
  EXPECT(foxhunt_site_init(&site, sizeof site, map, length - 1, &config) == FOXHUNT_RESULT_MAP_LENGTH);
  map[60] ^= 1;
  EXPECT(foxhunt_site_init(&site, sizeof site, map, length, &config) == FOXHUNT_RESULT_MAP_CHECKSUM);
  map[60] ^= 1;
  EXPECT(foxhunt_site_init(&site, sizeof site, map, length, &config) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_tracker_fix(&tracker, &fix) == FOXHUNT_RESULT_NOTHING);
  EXPECT(foxhunt_tracker_flush(&tracker, &site, &workspace, &generator) == FOXHUNT_RESULT_NO_WORKSPACE);
  EXPECT(foxhunt_workspace_init(&workspace, sizeof workspace) == FOXHUNT_RESULT_OK);
  /* 20 m into the tunnel, to a decibel or two, for ten seconds. */
  const float heard[4] = {-60, -55, -70, -72};
  uint32_t updates = 0;
  for (uint32_t time_ms = 0; time_ms < 10000; time_ms += 500) {
    for (uint8_t beacon = 0; beacon < 4; beacon++) {
      uint32_t updated;
      EXPECT(foxhunt_tracker_push(&tracker, time_ms, beacon, heard[beacon], &site, &workspace, &generator, &updated,
                                  &fix) == FOXHUNT_RESULT_OK);
      updates += updated;
    }
  }
  EXPECT(updates > 5);
  EXPECT(foxhunt_tracker_push(&tracker, 0, 0, -60, &site, &workspace, &generator, 0, 0) == FOXHUNT_RESULT_OLD_PACKET);
  EXPECT(foxhunt_tracker_push(&tracker, 0, 4, -60, &site, &workspace, &generator, 0, 0) == FOXHUNT_RESULT_BEACON);
  EXPECT(foxhunt_tracker_push(&tracker, 0, 0, 99, &site, &workspace, &generator, 0, 0) == FOXHUNT_RESULT_STRENGTH);
  EXPECT(foxhunt_tracker_flush(&tracker, &site, &workspace, &generator) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_tracker_fix(&tracker, &fix) == FOXHUNT_RESULT_OK);
  EXPECT(fabsf(fix.x_m - 20) < 6);
  EXPECT(foxhunt_site_beacon(&site, 0xFFFFFFFF) == -1);
  EXPECT(foxhunt_tracker_reset(&tracker) == FOXHUNT_RESULT_OK);

  static FoxhuntBeacon beacon;
  static char packets[1 << 20];
  FoxhuntBeaconConfig how;
  foxhunt_beacon_config_default(&how);
  how.silence_ms = 1;
  EXPECT(memcmp(foxhunt_beacon_config_fault(&site, &how).bytes, "silence_ms must be", 18) == 0);
  EXPECT(foxhunt_beacon_init(&beacon, sizeof beacon, &site, &how) == FOXHUNT_RESULT_CONFIG);
  foxhunt_beacon_config_default(&how);
  EXPECT(foxhunt_beacon_init(&beacon, sizeof beacon, &site, &how) == FOXHUNT_RESULT_OK);
  length = read_file(data, "tunnel.packets", packets, sizeof packets);
  uint32_t fixes = 0, tag = 0;
  for (size_t i = 0; i < length; i++) {
    FoxhuntBeaconEvent event;
    EXPECT(foxhunt_beacon_push(&beacon, (uint8_t)packets[i], &event) == FOXHUNT_RESULT_OK);
    if (event.kind == FOXHUNT_BEACON_EVENT_KIND_FIX) {
      fixes++;
      tag = event.tag;
      EXPECT(memcmp(foxhunt_beacon_report(&beacon).bytes, "$PFOXT,", 7) == 0);
    }
  }
  EXPECT(fixes > 100);
  EXPECT(foxhunt_beacon_fix(&beacon, tag, &fix) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_beacon_restart(&beacon) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_beacon_fix(&beacon, tag, &fix) == FOXHUNT_RESULT_NOTHING);
}

static void gateways(void) {
  static FoxhuntRobustVehicle vehicle;
  FoxhuntRobustVehicleConfig config;
  FoxhuntEvent event;
  foxhunt_robust_vehicle_config_city(&config);
  EXPECT(foxhunt_robust_vehicle_config_fault(&config).length == 0);
  EXPECT(foxhunt_robust_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_OK);
  const char lines[] = "%045/7\r\n$PFOXQ*50\r\n";
  FoxhuntEventKind kinds[2];
  int count = 0;
  for (size_t i = 0; i < strlen(lines); i++) {
    EXPECT(foxhunt_robust_vehicle_push(&vehicle, 2, (uint8_t)lines[i], &event) == FOXHUNT_RESULT_OK);
    if (event.kind != FOXHUNT_EVENT_KIND_NONE) {
      EXPECT(count < 2);
      kinds[count++] = event.kind;
      if (event.kind == FOXHUNT_EVENT_KIND_REJECTED) {
        EXPECT(event.rejected == FOXHUNT_REJECTED_NO_POSITION);
        EXPECT(memcmp(foxhunt_rejected_text(event.rejected).bytes, "no position", 11) == 0);
      }
    }
  }
  EXPECT(count == 2 && kinds[0] == FOXHUNT_EVENT_KIND_REJECTED && kinds[1] == FOXHUNT_EVENT_KIND_QUERIED);
  FoxhuntText report = foxhunt_robust_vehicle_report(&vehicle);
  EXPECT(report.length > 20 && memcmp(report.bytes, "$PFOXN,,FEW,0,,*", 16) == 0);
  EXPECT(foxhunt_robust_vehicle_restart(&vehicle) == FOXHUNT_RESULT_OK);
  EXPECT(foxhunt_robust_vehicle_push(&vehicle, 99, '\n', &event) == FOXHUNT_RESULT_PORT);
}

/* The example's drive, of which the event has metres, the report degrees and minutes, and both mean the same. */
static void places(const char *data) {
  static FoxhuntRobustVehicle vehicle;
  static char drive[1 << 20];
  FoxhuntRobustVehicleConfig config;
  FoxhuntPlace place;
  foxhunt_robust_vehicle_config_city(&config);
  config.lines.report_interval_ms = 0;
  EXPECT(foxhunt_robust_vehicle_init(&vehicle, sizeof vehicle, &config) == FOXHUNT_RESULT_OK);
  size_t length = read_file(data, "drive.nmea", drive, sizeof drive);
  int fixes = 0;
  for (size_t i = 0; i < length; i++) {
    FoxhuntEvent event;
    EXPECT(foxhunt_robust_vehicle_push(&vehicle, 0, (uint8_t)drive[i], &event) == FOXHUNT_RESULT_OK);
    if (event.kind == FOXHUNT_EVENT_KIND_FIX) {
      const FoxhuntFix *fix = &event.answer.fix;
      EXPECT(foxhunt_robust_vehicle_place(&vehicle, fix->east_m, fix->north_m, &place) == FOXHUNT_RESULT_OK);
      char report[256] = "";
      FoxhuntText text = foxhunt_robust_vehicle_report(&vehicle);
      memcpy(report, text.bytes, text.length < sizeof report - 1 ? text.length : sizeof report - 1);
      double latitude, longitude;
      EXPECT(sscanf(report, "$PFOXF,%*[^,],%lf,N,%lf,E", &latitude, &longitude) == 2);
      const double degrees[2] = {floor(latitude / 100), floor(longitude / 100)};
      EXPECT(fabs((degrees[0] + (latitude - 100 * degrees[0]) / 60) * 1e7 - place.latitude_e7) < 1);
      EXPECT(fabs((degrees[1] + (longitude - 100 * degrees[1]) / 60) * 1e7 - place.longitude_e7) < 1);
      fixes++;
    }
  }
  EXPECT(fixes > 5);
  EXPECT(foxhunt_robust_vehicle_place(&vehicle, NAN, 0, &place) == FOXHUNT_RESULT_POSITION);
}

void locators(const char *data) {
  EXPECT(foxhunt_generator_init(&generator, sizeof generator, 1) == FOXHUNT_RESULT_OK);
  clean_locator();
  robust_locator();
  several_sources();
  tags(data);
  gateways();
  places(data);
  EXPECT(fabsf(foxhunt_to_compass(foxhunt_from_compass(123)) - 123) < 1e-3f);
}
