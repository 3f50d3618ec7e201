/* The gateway of a vehicle in C: feeds it a recorded drive, and prints its reports.
 *
 * `cargo xtask c` builds it for this computer and for the emulated board, and compares what both print with the gateway in
 * Rust. */

#include "foxhunt.h"
#include "machine.h"

static FoxhuntVehicle vehicle;

int main(void) {
  FoxhuntVehicleConfig config;
  foxhunt_vehicle_config_default(&config);
  FoxhuntResult result = foxhunt_vehicle_init(&vehicle, sizeof vehicle, &config);
  if (result != FOXHUNT_RESULT_OK) {
    FoxhuntText text = foxhunt_error_text(result);
    machine_write(text.bytes, text.length);
    return 1;
  }
  for (const unsigned char *byte = drive_begin; byte != drive_end; byte++) {
    FoxhuntEvent event;
    foxhunt_vehicle_push(&vehicle, 0, *byte, &event);
    if (event.kind != FOXHUNT_EVENT_KIND_NONE) {
      FoxhuntText report = foxhunt_vehicle_report(&vehicle);
      machine_write(report.bytes, report.length);
    }
  }
  return 0;
}
