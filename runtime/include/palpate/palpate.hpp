// SPDX-License-Identifier: MIT
// The whole runtime of a force loop. Include single headers where a program needs less, and palpate/shared/dent.hpp
// where it draws the body.
#pragma once

#include "palpate/body/deforming_body.hpp"
#include "palpate/body/rigid_motion.hpp"
#include "palpate/body/stiffness_scale.hpp"
#include "palpate/contact/bonded_contact.hpp"
#include "palpate/contact/contact.hpp"
#include "palpate/contact/contact_set.hpp"
#include "palpate/contact/superposition.hpp"
#include "palpate/format/open.hpp"
#include "palpate/format/response_view.hpp"
#include "palpate/mechanism/constraint.hpp"
#include "palpate/mechanism/mechanism.hpp"
#include "palpate/mechanism/rows.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/energy_meter.hpp"
#include "palpate/output/output_chain.hpp"
#include "palpate/output/passivity_controller.hpp"
#include "palpate/output/virtual_coupling.hpp"
#include "palpate/shared/compliance.hpp"
#include "palpate/shared/contact_slope.hpp"
#include "palpate/shared/joint_contacts.hpp"
#include "palpate/shared/tool_set.hpp"
#include "palpate/threading/triple_buffer.hpp"
