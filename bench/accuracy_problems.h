// The problems of the work-precision study, each over the methods and resolutions of its size.
#pragma once

#include "bench/accuracy_row.h"
#include "bench/study_plan.h"

#include <filesystem>

namespace rend {

enum class StudySize { smallest, quick, full };

using AccuracyPlan = StudyPlan<AccuracyRow>;

/// A guess of the CPU time [s] of one particle in one step.
Real guessed_seconds(const SolverDesc& solver, ForceKind force = ForceKind::particle);

/// P1, a manufactured wave in a cube: displacement, velocity, stress ("wave"), the same with
/// particles that cross cells ("large_wave"), and in one dimension down to the end of float
/// ("column").
void study_waves(StudySize size, AccuracyPlan& plan);
/// P2, a ball that turns: mechanical energy and spin.
void study_turning(StudySize size, AccuracyPlan& plan);
/// P3, two balls that collide: mechanical energy, momentum and spin.
void study_collision(StudySize size, AccuracyPlan& plan);
/// P4, a block driven through yield and softening: stress and dissipation.
void study_driven(StudySize size, AccuracyPlan& plan);
/// P5, a bar torn by grips: energy of the crack over the fracture energy, peak force.
void study_rupture(StudySize size, AccuracyPlan& plan);
/// P6, Taylor's bar: length and foot; `scenes` holds taylor_bar.json.
void study_impact(StudySize size, const std::filesystem::path& scenes, AccuracyPlan& plan);

/// Transfers that the study compares on the reference solver, and those of the tile solver.
std::vector<SolverDesc> studied_methods(Kernel kernel, ForceForm form);
std::vector<SolverDesc> tile_methods();

}  // namespace rend
