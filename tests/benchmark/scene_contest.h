// Other ways to sample surfaces to a chord error, beside plans of scenes.
#pragma once

namespace darboux::bench {

// Prints the tables.
void contest_of_scenes(int rounds);

}  // namespace darboux::bench
