// SPDX-License-Identifier: MIT
#include "device/device.hpp"

#include <chrono>

namespace palpate::device {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

const char* name(Phase phase) {
  switch (phase) {
    case Phase::closed:
      return "closed";
    case Phase::starting:
      return "starting";
    case Phase::homing:
      return "homing";
    case Phase::ready:
      return "ready";
    case Phase::stopped:
      return "stopped";
  }
  return "unknown";
}

const char* name(Fault fault) {
  switch (fault) {
    case Fault::none:
      return "none";
    case Fault::unplugged:
      return "unplugged";
    case Fault::refused:
      return "refused: no permission, or in use";
    case Fault::stalled:
      return "the endpoint stalls";
    case Fault::silent:
      return "nothing arrives";
    case Fault::garbled:
      return "the received bytes form no packet";
    case Fault::impossible:
      return "the received values are impossible";
    case Fault::firmware:
      return "the firmware was not accepted, or is one that has no driver";
    case Fault::host_late:
      return "the force loop stopped sending";
    case Fault::reported:
      return "the device reports a fault";
  }
  return "unknown";
}

}  // namespace palpate::device
