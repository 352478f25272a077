// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/spare_descriptors.hpp"

#include <sys/eventfd.h>
#include <sys/resource.h>

#include "common/host/descriptor.hpp"

namespace clearway::host {

bool HasDescriptorsToSpare() {
  rlimit limit{};
  // The system gives the lowest number that is free: all below it are in use.
  const Descriptor lowest(eventfd(0, EFD_CLOEXEC));
  if (!lowest.is_open() || getrlimit(RLIMIT_NOFILE, &limit) != 0) return false;
  return static_cast<rlim_t>(lowest.get() + kSpareDescriptors) < limit.rlim_cur;
}

}  // namespace clearway::host
