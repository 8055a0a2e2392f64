// SPDX-License-Identifier: MIT
#pragma once

#include "hdf5_handle.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

void write_root_attributes(hid_t root, const Session& session);

void write_camera_attributes(hid_t group, const Session& session);
void write_sync_attributes(hid_t group, const Session& session);
void write_clock_attributes(hid_t group, const ClockReport& clock);
void write_samples_attributes(hid_t group, const Session& session);
void write_estimates_attributes(hid_t group, const Session& session);
void write_environment_attributes(hid_t group, const Session& session);
void write_rig_attributes(hid_t group, const Session& session);
void write_raw_attributes(hid_t group, const wire::Counters& counters);
void write_quality_attributes(hid_t group, const Quality& quality);

}  // namespace thermorig::session
