// SPDX-License-Identifier: Apache-2.0
// The results of a contact study for atlas.html.
#pragma once

#include <string>

#include "tools/fovea/contact/study.hpp"

namespace fovea::contact {

// The page's main part, for AtlasPage::Wrap.
std::string ToHtml(const Study& study);

}  // namespace fovea::contact
