// Two services for one robot: one answers, the other takes over.
#include "tests/service/service_fixture.h"
