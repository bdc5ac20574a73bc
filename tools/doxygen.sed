# Turns plain comments in headers into Doxygen comments: a comment line becomes ///, a comment after code becomes ///<.
1s|^// \(.*\)$|/// @file\n/// \1|
# A word for clang-tidy is no documentation.
s|// NOLINT.*$||
s|^\( *\)// |\1/// |
s|^\( *\)//$|\1///|
s|\([;,{})]\) *// |\1  ///< |
# A link to a page that is not in the reference becomes plain text.
s/\[\([^]]*\)\]([^)]*\(README\|RESULTS\|DEPENDENCIES\|CONTRIBUTING\)\.md[^)]*)/\1/g
