// The words that go with HTTP status codes.
#pragma once

namespace rend::web {

/// Reason phrase of `status` (RFC 9110 section 15), "Error" for one that is not used here.
const char* status_title(int status);

}  // namespace rend::web
