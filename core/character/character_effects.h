// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// All effects that a character may have.
#include "core/character/bend_warp_job.h"
#include "core/character/body_loads_job.h"
#include "core/character/joint_dynamics_job.h"
#include "core/character/previous_model_job.h"
#include "core/character/smooth_joints_job.h"
#include "core/character/touch_job.h"
