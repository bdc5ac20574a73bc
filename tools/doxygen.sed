# Plain comments to Doxygen's, in headers only: a line that is a comment becomes ///, one behind code ///<.
1s|^// \(.*\)$|/// @file\n/// \1|
s|^\( *\)// |\1/// |
s|^\( *\)//$|\1///|
s|\([;,{})]\) *// |\1  ///< |
# Of pages that are not in the reference, the name alone.
s/\[\([^]]*\)\]([^)]*\(README\|RESULTS\|DEPENDENCIES\|CONTRIBUTING\)\.md[^)]*)/\1/g
