// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

// One function a command. Each prints its results on standard output, throws Error where the world refuses,
// and returns the exit code otherwise.

ExitCode run(const RecordOptions& options);
ExitCode run(const LiveOptions& options);
ExitCode run(const CalibrateOptions& options);
ExitCode run(const SetupOptions& options);
ExitCode run(const PortsOptions& options);
ExitCode run(const LookOptions& options);
ExitCode run(const SimulateOptions& options);
ExitCode run(const InspectOptions& options);
ExitCode run(const ViewOptions& options);
ExitCode run(const ListOptions& options);
ExitCode run(const AnnotateOptions& options);
ExitCode run(const DatasetOptions& options);
ExitCode run(const RecoverOptions& options);
ExitCode run(const ReprocessOptions& options);
ExitCode run(const DecodeOptions& options);
ExitCode run(const TrainOptions& options);
ExitCode run(const EvaluateOptions& options);
ExitCode run(const ExportOptions& options);
ExitCode run(const VersionOptions& options);
ExitCode run(const DoctorOptions& options);
ExitCode run(const ManPagesOptions& options);

}  // namespace thermorig::app
