#include "dem/io.h"
