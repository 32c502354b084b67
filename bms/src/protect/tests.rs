mod alone;
mod debounce;
mod judge;
mod latch;
mod rest;
mod scene;
mod table;
mod time;
