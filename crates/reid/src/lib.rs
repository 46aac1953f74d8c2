//! Who is who: the only memory of objects.
