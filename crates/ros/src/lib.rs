//! ROS 2 messages, publishers and bags.
